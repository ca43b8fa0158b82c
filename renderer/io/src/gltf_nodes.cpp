#include "gltf_nodes.hpp"

#include <cmath>
#include <string>
#include <utility>

#include "gltf_lights.hpp"
#include "raykiln/scene/camera.hpp"

namespace raykiln::render::io {
namespace {

constexpr double kLargestView = 1e15;  ///< half the height that an orthographic camera sees

// Column j of a rotation by the quaternion (x, y, z, w), brought to unit length.
Mat4d rotation(const std::vector<double>& q) {
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!std::isfinite(norm) || !(norm > 0.0)) return Mat4d(1.0);
  const double x = q[0] / norm;
  const double y = q[1] / norm;
  const double z = q[2] / norm;
  const double w = q[3] / norm;
  Mat4d m(1.0);
  m[0] = Vec4d(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w), 0.0);
  m[1] = Vec4d(2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w), 0.0);
  m[2] = Vec4d(2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y), 0.0);
  return m;
}

Mat4d from_matrix(const std::vector<double>& v) {
  Mat4d m(1.0);
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 3; ++row) m[column][row] = v[static_cast<std::size_t>(4 * column + row)];
  }
  return m;  // the last row of an affine transform is 0 0 0 1
}

// T * R * S. Wrong types are recorded and read as the identity.
Mat4d local_transform(const JsonAt& node) {
  if (const auto at = node.find("matrix")) {
    const auto values = at->numbers(16);
    return values ? from_matrix(*values) : Mat4d(1.0);
  }
  const Vec3d shift = node.vec3_or("translation", Vec3d(0.0));
  const Vec3d scale = node.vec3_or("scale", Vec3d(1.0));
  Mat4d m(1.0);
  if (const auto at = node.find("rotation")) {
    if (const auto q = at->numbers(4)) m = rotation(*q);
  }
  for (int axis = 0; axis < 3; ++axis) m[axis] *= scale[axis];
  m[3] = Vec4d(shift, 1.0);
  return m;
}

std::optional<std::uint64_t> light_index(const JsonAt& node) {
  const auto extensions = node.object("extensions");
  const auto lights = extensions ? extensions->object("KHR_lights_punctual") : std::nullopt;
  if (!lights || !lights->has("light")) return std::nullopt;
  return lights->member("light").integer();
}

}  // namespace

GltfNodes::GltfNodes(JsonAt root, GltfMeshes& meshes, SceneDraft& draft)
    : root_(std::move(root)), nodes_(root_.array("nodes")), meshes_(&meshes), draft_(&draft) {
  if (nodes_) on_path_.resize(nodes_->size());
}

bool GltfNodes::roots(std::vector<std::uint64_t>& ids) {
  const auto scenes = root_.array("scenes");
  const std::uint64_t chosen = root_.integer_or("scene", 0);
  if (root_.diagnostics().failed()) return false;
  if (scenes && scenes->size() > 0) {
    if (chosen >= scenes->size()) {
      return root_.member("scene").fail(ImportErrorCode::kIndexOutOfRange,
                                        "there is no scene " + std::to_string(chosen));
    }
    const JsonAt scene = scenes->element(static_cast<std::size_t>(chosen));
    if (!scene.expect_object()) return false;
    const auto list = scene.array("nodes");
    for (std::size_t i = 0; list && i < list->size(); ++i) {
      const auto id = list->element(i).integer();
      if (!id) return false;
      ids.push_back(*id);
    }
    return !root_.diagnostics().failed();
  }
  std::vector<bool> is_child(on_path_.size(), false);
  for (std::size_t i = 0; i < on_path_.size(); ++i) {
    const auto children = nodes_->element(i).array("children");
    for (std::size_t k = 0; children && k < children->size(); ++k) {
      const auto id = children->element(k).integer();
      if (id && *id < is_child.size()) is_child[static_cast<std::size_t>(*id)] = true;
    }
  }
  for (std::size_t i = 0; i < is_child.size(); ++i) {
    if (!is_child[i]) ids.push_back(i);
  }
  return !root_.diagnostics().failed();
}

bool GltfNodes::walk() {
  std::vector<std::uint64_t> ids;
  if (root_.diagnostics().failed() || !roots(ids)) return false;
  for (const std::uint64_t id : ids) {
    if (!visit(id, Mat4d(1.0), 1, root_)) return false;
  }
  return true;
}

bool GltfNodes::visit(std::uint64_t index, const Mat4d& parent, std::size_t depth,
                      const JsonAt& at) {
  Diagnostics& diagnostics = root_.diagnostics();
  const ImportLimits& limits = diagnostics.limits();
  if (!diagnostics.may_go_on()) return false;
  if (index >= on_path_.size()) {
    return at.fail(ImportErrorCode::kIndexOutOfRange, "there is no node " + std::to_string(index));
  }
  const auto i = static_cast<std::size_t>(index);
  const JsonAt node = nodes_->element(i);
  if (!node.expect_object()) return false;
  if (on_path_[i]) return node.fail(ImportErrorCode::kNodeCycle, "the node is its own descendant");
  if (depth > limits.max_node_depth || ++visits_ > limits.max_node_visits) {
    return node.fail(ImportErrorCode::kLimitExceeded,
                     depth > limits.max_node_depth ? "the node tree is too deep"
                                                   : "the scene has too many nodes");
  }
  const Mat4d to_world = parent * local_transform(node);
  if (!contents(node, to_world)) return false;
  const auto children = node.array("children");
  on_path_[i] = true;
  for (std::size_t k = 0; children && k < children->size(); ++k) {
    const auto child = children->element(k).integer();
    if (!child || !visit(*child, to_world, depth + 1, node)) return false;
  }
  on_path_[i] = false;
  return !diagnostics.failed();
}

bool GltfNodes::contents(const JsonAt& node, const Mat4d& to_world) {
  if (const auto at = node.find("mesh")) {
    const auto index = at->integer();
    draft_->use_object(draft_->add_object(clean_text(node.text_or("name", ""), kMaxNameBytes)));
    if (!index || !meshes_->instantiate(*index, to_world, *at)) return false;
    if (node.has("skin")) {
      node.warn(ImportWarningCode::kIgnoredFeature, "skins are ignored: the rest pose is shown");
    }
  }
  if (const auto at = node.find("camera")) {
    const auto index = at->integer();
    if (!index || !camera(node, *index, to_world)) return false;
  }
  const auto index = light_index(node);
  if (index && !light(node, *index, to_world)) return false;
  return !node.diagnostics().failed();
}

// A glTF camera looks along -z of its node with +y up. The picture's shape is the job's, so of an
// orthographic camera ymag alone counts; a negative one, which the specification discourages, as its size.
bool GltfNodes::camera(const JsonAt& node, std::uint64_t index, const Mat4d& to_world) {
  const auto cameras = root_.array("cameras");
  if (!cameras || index >= cameras->size()) {
    return node.fail(ImportErrorCode::kIndexOutOfRange,
                     "there is no camera " + std::to_string(index));
  }
  const JsonAt at = cameras->element(static_cast<std::size_t>(index));
  if (!at.expect_object()) return false;
  if (draft_->cameras.size() >= node.diagnostics().limits().max_cameras) {
    return at.fail(ImportErrorCode::kLimitExceeded, "too many cameras");
  }
  const auto perspective = at.object("perspective");
  const auto orthographic = at.object("orthographic");
  if (!perspective && !orthographic) {
    at.warn(ImportWarningCode::kUnsupportedCamera, "a camera that is neither perspective nor orthographic is ignored");
    return !at.diagnostics().failed();
  }
  const JsonAt& lens = perspective ? *perspective : *orthographic;
  if (const char* field = perspective ? "yfov" : "ymag"; !lens.has(field)) {
    return lens.fail(ImportErrorCode::kMissingField, std::string("the field '") + field + "' is missing");
  }
  DraftCamera made;
  made.name = clean_text(at.text_or("name", node.text_or("name", "")));
  if (made.name.empty()) made.name = "camera " + std::to_string(draft_->cameras.size() + 1);
  if (perspective) made.fov_y_rad = lens.number_in("yfov", 0.7, 1e-6, 3.1398);
  if (!perspective) made.view_height = 2.0 * std::abs(lens.number_in("ymag", 1.0, -kLargestView, kLargestView));
  made.eye = Vec3d(to_world[3]);
  made.forward = -Vec3d(to_world[2]);
  made.up = Vec3d(to_world[1]);
  if (at.diagnostics().failed()) return false;
  const bool nothing_in_view = !perspective && !(made.view_height > 0.0);
  if (nothing_in_view || !make_camera("", made.eye, made.forward, made.up, made.fov_y_rad, Vec3d(0.0))) {
    node.warn(ImportWarningCode::kUnsupportedCamera, "a camera with a flat transform or view is ignored");
    return true;
  }
  draft_->cameras.push_back(std::move(made));
  return true;
}

bool GltfNodes::light(const JsonAt& node, std::uint64_t index, const Mat4d& to_world) {
  const auto extensions = root_.object("extensions");
  const auto holder = extensions ? extensions->object("KHR_lights_punctual") : std::nullopt;
  const auto lights = holder ? holder->array("lights") : std::nullopt;
  if (!lights || index >= lights->size()) {
    return node.fail(ImportErrorCode::kIndexOutOfRange, "there is no light " + std::to_string(index));
  }
  const JsonAt at = lights->element(static_cast<std::size_t>(index));
  if (!at.expect_object()) return false;
  const ImportLimits& limits = node.diagnostics().limits();
  if (draft_->lights.size() >= limits.max_lights) {
    return at.fail(ImportErrorCode::kLimitExceeded, "too many lights");
  }
  const auto made = read_gltf_light(at, node, to_world);
  if (made) draft_->lights.push_back(*made);
  return !at.diagnostics().failed();
}

}  // namespace raykiln::render::io
