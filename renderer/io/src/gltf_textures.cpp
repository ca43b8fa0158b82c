#include "gltf_textures.hpp"

#include <cmath>
#include <string>
#include <utility>

#include "uri.hpp"

namespace raykiln::render::io {
namespace {

constexpr std::uint64_t kNearest = 9728, kLinear = 9729;
constexpr std::uint64_t kClampToEdge = 33071, kMirroredRepeat = 33648, kRepeat = 10497;
constexpr double kLargestTransform = 1e6;

bool read_wrap(const JsonAt& sampler, const char* key, TextureWrap& wrap) {
  switch (sampler.integer_or(key, kRepeat)) {
    case kRepeat: wrap = TextureWrap::kRepeat; return true;
    case kMirroredRepeat: wrap = TextureWrap::kMirror; return true;
    case kClampToEdge: wrap = TextureWrap::kClamp; return true;
    default: return sampler.member(key).fail(ImportErrorCode::kInvalidValue, "no wrap mode");
  }
}

bool read_pair(const JsonAt& at, const char* key, double& first, double& second) {
  const auto field = at.find(key);
  if (!field) return !at.diagnostics().failed();
  const auto values = field->numbers(2);
  if (!values) return false;
  first = (*values)[0];
  second = (*values)[1];
  const bool sane = std::abs(first) <= kLargestTransform && std::abs(second) <= kLargestTransform;
  return sane || field->fail(ImportErrorCode::kInvalidValue, "a number is too large");
}

// offset + rotation (scale (u, v)), the rotation counter-clockwise with v pointing down.
bool read_transform(const JsonAt& info, TextureUse& use, std::uint64_t& uv_set) {
  const auto extensions = info.object("extensions");
  const auto at = extensions ? extensions->object("KHR_texture_transform") : std::nullopt;
  if (!at) return !info.diagnostics().failed();
  double offset_u = 0.0, offset_v = 0.0, scale_u = 1.0, scale_v = 1.0;
  const double turn = at->number_in("rotation", 0.0, -kLargestTransform, kLargestTransform);
  if (!read_pair(*at, "offset", offset_u, offset_v) || !read_pair(*at, "scale", scale_u, scale_v)) {
    return false;
  }
  const double c = std::cos(turn), s = std::sin(turn);
  use.u_row = {c * scale_u, s * scale_v, offset_u};
  use.v_row = {-s * scale_u, c * scale_v, offset_v};
  uv_set = at->integer_or("texCoord", uv_set);
  return !info.diagnostics().failed();
}

}  // namespace

GltfTextures::GltfTextures(const SceneFiles& files, JsonAt root, GltfBuffers& buffers,
                           SceneDraft& draft)
    : files_(&files), root_(std::move(root)), buffers_(&buffers), draft_(&draft) {}

std::optional<JsonAt> GltfTextures::element(const char* list, std::uint64_t index,
                                            const JsonAt& at) {
  const auto all = root_.array(list);
  if (!all || index >= all->size()) {
    at.fail(ImportErrorCode::kIndexOutOfRange,
            "there is no element " + std::to_string(index) + " in " + list);
    return std::nullopt;
  }
  JsonAt found = all->element(static_cast<std::size_t>(index));
  if (!found.expect_object()) return std::nullopt;
  return found;
}

bool GltfTextures::read_sampler(const JsonAt& texture, TextureUse& use) {
  if (!texture.has("sampler")) return true;
  const auto index = texture.member("sampler").integer();
  const auto sampler = index ? element("samplers", *index, texture) : std::nullopt;
  if (!sampler) return false;
  if (sampler->integer_or("magFilter", kLinear) == kNearest) use.filter = TextureFilter::kNearest;
  return read_wrap(*sampler, "wrapS", use.wrap_u) && read_wrap(*sampler, "wrapT", use.wrap_v) &&
         !texture.diagnostics().failed();
}

std::optional<std::uint32_t> GltfTextures::image(const JsonAt& texture, PictureRole role) {
  Diagnostics& diagnostics = root_.diagnostics();
  const PictureUser user{texture.file(), texture.pointer()};
  if (!texture.has("source")) {
    return draft_->textures.unusable(ImportErrorCode::kInvalidPicture,
                                     "the texture has no source that is PNG or JPEG", user,
                                     diagnostics);
  }
  const auto index = texture.member("source").integer();
  const auto at = index ? element("images", *index, texture) : std::nullopt;
  if (!at) return std::nullopt;
  // A name that no file of the upload has: the names of files never begin with a slash.
  const std::string key = "/images/" + std::to_string(*index);
  if (const auto id = draft_->textures.known(key, role)) return id;
  if (at->has("bufferView")) {
    const auto view = at->member("bufferView").integer();
    const auto bytes = view ? buffers_->view(*view, *at) : std::nullopt;
    if (!bytes) return std::nullopt;
    return draft_->textures.embedded(key, *bytes, user, role, diagnostics);
  }
  const auto uri = at->has("uri") ? at->member("uri").text_view() : std::nullopt;
  if (!uri) {
    at->fail(ImportErrorCode::kMissingField, "an image needs a uri or a bufferView");
    return std::nullopt;
  }
  if (const auto encoded = base64_part(*uri)) {
    const auto bytes = decode_base64(*encoded);
    if (bytes) return draft_->textures.embedded(key, *bytes, user, role, diagnostics);
    at->fail(ImportErrorCode::kInvalidValue, "the base64 text is damaged");
    return std::nullopt;
  }
  const auto name = has_scheme(*uri) ? std::nullopt : decode_percent(*uri);
  return draft_->textures.beside(*files_, name ? *name : std::string(*uri), user, role, diagnostics);
}

std::optional<TextureUse> GltfTextures::use(const JsonAt& holder, const char* key,
                                            PictureRole role) {
  TextureUse use;
  use.data = role != PictureRole::kColour && role != PictureRole::kEmission;
  const auto info = holder.object(key);
  if (!info) return holder.diagnostics().failed() ? std::nullopt : std::optional(use);
  if (!info->has("index")) {
    info->fail(ImportErrorCode::kMissingField, "the field 'index' is missing");
    return std::nullopt;
  }
  const auto index = info->member("index").integer();
  const auto texture = index ? element("textures", *index, *info) : std::nullopt;
  std::uint64_t uv_set = info->integer_or("texCoord", 0);
  if (!texture || !read_transform(*info, use, uv_set) || !read_sampler(*texture, use)) {
    return std::nullopt;
  }
  std::optional<std::uint32_t> id;
  if (uv_set > 1) {
    id = draft_->textures.unusable(
        ImportErrorCode::kInvalidValue,
        "texture coordinates are TEXCOORD_0 or TEXCOORD_1, not " + std::to_string(uv_set),
        {info->file(), info->pointer()}, root_.diagnostics());
  } else {
    use.uv_set = static_cast<std::uint8_t>(uv_set);
    id = image(*texture, role);
  }
  if (!id) return std::nullopt;
  use.image = *id;
  return use;
}

}  // namespace raykiln::render::io
