#include "raykiln/scene/scene.hpp"
