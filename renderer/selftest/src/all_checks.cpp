#include <numbers>

#include "raykiln/selftest/coverage.hpp"
#include "raykiln/selftest/direct_light.hpp"
#include "raykiln/selftest/enclosures.hpp"
#include "raykiln/selftest/form_factors.hpp"
#include "raykiln/selftest/glass.hpp"
#include "raykiln/selftest/mirrors.hpp"
#include "raykiln/selftest/refraction.hpp"
#include "raykiln/selftest/selftest.hpp"
#include "raykiln/selftest/whole_renderer.hpp"

namespace raykiln::render::selftest {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr const char* kFourSigma = "4 standard errors";
constexpr const char* kExact = "relative error 1e-5";
constexpr const char* kSameBits = "the same bits";

void add_scenes(std::vector<Check>& checks) {
  checks.push_back({"T01", "white furnace, albedo 0.5, physical", kFourSigma,
                    [] { return white_furnace(0.5, kPhysicalModel); }});
  checks.push_back({"T01", "white furnace, albedo 0.8, physical", kFourSigma,
                    [] { return white_furnace(0.8, kPhysicalModel); }});
  checks.push_back({"T01", "white furnace, albedo 0.5, seed", kFourSigma,
                    [] { return white_furnace(0.5, kSeedModel); }});
  checks.push_back({"T02", "furnace cut at 4 reflections, albedo 0.8", kExact,
                    [] { return truncated_furnace(0.8, 4); }});
  checks.push_back({"T02", "furnace cut at 16 reflections, albedo 0.9", kExact,
                    [] { return truncated_furnace(0.9, 16); }});
  checks.push_back({"T03", "point light over a diffuse plane", kExact, [] { return light_over_plane({}); }});
  checks.push_back({"T04", "point light, mean over a square", kFourSigma,
                    [] { return light_over_square({.height = 0.5, .distance = 1.0}, 4096); }});
  checks.push_back({"T05", "square emitter over a point, emitter sampling", kFourSigma,
                    [] { return square_over_element({}, true, 8192); }});
  checks.push_back({"T05", "square emitter over a point, by reflection alone", kFourSigma,
                    [] { return square_over_element({}, false, 8192); }});
  checks.push_back({"T06", "two squares that light each other, emitter", kFourSigma,
                    [] { return parallel_squares({}, 1, 4096); }});
  checks.push_back({"T06", "two squares that light each other, receiver", kFourSigma,
                    [] { return parallel_squares({}, 2, 4096); }});
  checks.push_back({"T07", "two squares with a common edge", kFourSigma,
                    [] { return touching_rectangles({}, true, 1024); }});
  checks.push_back({"T14", "prism at minimum deviation", "every path within 1e-5 rad",
                    [] { return prism_deviation(1.5, 60.0 * kDegree, 4096); }});
  checks.push_back({"T15", "edge seen through a slab at 60 degrees", "1/4 pixel",
                    [] { return slab_displacement(1.5, 60.0 * kDegree, 128); }});
  checks.push_back({"T16", "translucent sheet", kExact, [] { return translucent_sheet({}); }});
  checks.push_back({"T18", "half plane over a pixel", kFourSigma, [] { return pixel_coverage({}, 100000); }});
  checks.push_back({"T20", "umbra of a square", "dark inside, exact outside, but for one pixel",
                    [] { return umbra_of_square({.pixels = 256}); }});
}

/// A path limit alone ends paths: the truths below are those of a stated number of reflections.
LightModel without_roulette(LightModel model) {
  model.roulette = false;
  return model;
}

void add_enclosures_and_glass(std::vector<Check>& checks) {
  checks.push_back({"T08", "sphere with a light in its centre, albedo 0.5", "4 standard errors + 0.2 %",
                    [] { return sphere_with_light(0.5, kPhysicalModel, 16); }});
  checks.push_back({"T09", "sphere with an emitting cap, albedo 0.8", "4 standard errors + 0.3 %",
                    [] { return sphere_with_cap(0.8, false, kPhysicalModel, 16); }});
  checks.push_back({"T10", "facing mirrors, 20 reflections", "4 standard errors + 1e-4",
                    [] { return mirror_corridor({}, 20, without_roulette(kPhysicalModel), 64); }});
  checks.push_back({"T12", "glass slab at 60 degrees", kFourSigma, [] {
                      return slab(1.5, 60.0 * kDegree, -1, without_roulette(kPhysicalModel), 200000);
                    }});
  checks.push_back({"T13", "the window from below, index 1.5", "radius to one pixel",
                    [] { return window_from_below(1.5, kPhysicalModel); }});
  checks.push_back({"T17", "flux out of glass, physical", kFourSigma,
                    [] { return flux_out_of_glass(1.5, kPhysicalModel, 2048); }});
  checks.push_back({"T17", "flux out of glass, seed", kFourSigma,
                    [] { return flux_out_of_glass(1.5, kSeedModel, 2048); }});
}

void add_shading_cases(std::vector<Check>& checks) {
  checks.push_back({"S01", "Phong lobe of exponent 10 at 85 degrees in a furnace, physical", kFourSigma, [] {
                      return lobe_in_furnace(10.0, 85.0 * kDegree, 0.553509, 1e-6, kPhysicalModel, 200000);
                    }});
  checks.push_back({"S01", "the same at 80 degrees, seed", kFourSigma, [] {
                      return lobe_in_furnace(10.0, 80.0 * kDegree, 1.203880, 1e-6, kSeedModel, 200000);
                    }});
  checks.push_back({"S11", "mirror image of a point light, exponent 1e4", kFourSigma,
                    [] { return mirror_image(1e4, 0.399987, kPhysicalModel, 16); }});
  checks.push_back({"D09", "emitter in glass seen from outside", kFourSigma,
                    [] { return radiance_across_border(1.5, false, kPhysicalModel, 4096); }});
  checks.push_back({"D09", "emitter outside seen from within glass", kFourSigma,
                    [] { return radiance_across_border(1.5, true, kPhysicalModel, 4096); }});
}

void add_hard_cases(std::vector<Check>& checks) {
  checks.push_back({"K01", "wall of triangles in one plane", "every ray hits, as by brute force",
                    [] { return coplanar_wall(20000); }});
  checks.push_back({"V03", "closed mesh, rays at its edges and corners", "none gets out",
                    [] { return sealed_edges(1000000); }});
  checks.push_back({"L03", "point light 0.1 over a square of half-side 1", kFourSigma,
                    [] { return light_over_square({.height = 0.1, .distance = 1.0}, 4096); }});
  checks.push_back({"L06", "emitter of side 1e-4", kFourSigma, [] {
                      return square_over_element({.radiance = 1e8, .side = 1e-4}, true, 256);
                    }});
  checks.push_back({"L07", "two squares with a common edge, by reflection alone", kFourSigma,
                    [] { return touching_rectangles({}, false, 1024); }});
  checks.push_back({"M03", "NaN and infinite samples", "dropped and counted", [] { return bad_samples_counted(); }});
  checks.push_back({"M04", "a million samples in one pixel", "relative error 1e-12", [] { return a_million_samples(); }});
  checks.push_back({"M05", "1e5 samples of 1000 +- 0.01", "relative error of the variance 1e-6", [] { return variance_of_close_samples(); }});
  checks.push_back({"F04", "edge at a quarter of a pixel", kFourSigma,
                    [] { return pixel_coverage({.a = 1.0, .b = 0.0, .c = 0.25}, 100000); }});
  checks.push_back({"X01", "room scaled by 2^-30 .. 2^30", kSameBits, [] { return same_at_any_scale(); }});
  checks.push_back({"X03", "room by 12 trees and by brute force", kSameBits, [] { return same_for_any_tree(); }});
  checks.push_back({"X04", "all light times 2^-40 .. 2^40", "the same bits times that", [] { return linear_in_light(); }});
}

}  // namespace

std::vector<Check> all_checks() {
  std::vector<Check> checks;
  add_scenes(checks);
  add_enclosures_and_glass(checks);
  add_shading_cases(checks);
  add_hard_cases(checks);
  return checks;
}

}  // namespace raykiln::render::selftest
