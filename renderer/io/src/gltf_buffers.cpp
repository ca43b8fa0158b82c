#include "gltf_buffers.hpp"

#include <utility>

#include "scene_file_names.hpp"
#include "uri.hpp"

namespace raykiln::render::io {

GltfBuffers::GltfBuffers(const SceneFiles& files, JsonAt root,
                         std::optional<std::string_view> glb_chunk)
    : files_(&files),
      root_(std::move(root)),
      glb_chunk_(glb_chunk),
      buffers_(root_.array("buffers")),
      views_(root_.array("bufferViews")) {
  if (!buffers_) return;
  owned_.resize(buffers_->size());
  loaded_.resize(buffers_->size());
}

bool GltfBuffers::load_uri(std::string_view uri, const JsonAt& at, std::string& bytes) {
  Diagnostics& diagnostics = at.diagnostics();
  if (const auto encoded = base64_part(uri)) {
    auto decoded = decode_base64(*encoded);
    if (!decoded) return at.fail(ImportErrorCode::kInvalidValue, "the base64 text is damaged");
    bytes = std::move(*decoded);
    return true;
  }
  if (has_scheme(uri)) {
    return at.fail(ImportErrorCode::kFileMissing,
                   "the buffer " + in_quotes(uri) + " is not part of the upload",
                   "export with local or embedded buffers");
  }
  const auto name = decode_percent(uri);
  const auto found = name ? find_beside(*files_, at.file(), *name) : std::nullopt;
  if (!found) {
    return at.fail(ImportErrorCode::kFileMissing, "there is no file " + in_quotes(uri),
                   "add the file to the upload");
  }
  auto whole = read_whole(*files_, *found, diagnostics.limits().max_buffer_bytes, diagnostics);
  if (!whole) return false;
  bytes = std::move(*whole);
  return true;
}

bool GltfBuffers::load(std::size_t index, const JsonAt&) {
  const JsonAt at = buffers_->element(index);
  if (!at.expect_object()) return false;
  const std::uint64_t claimed = at.integer_or("byteLength", 0);
  std::string_view bytes;
  if (const auto uri = at.find("uri")) {
    const auto text = uri->text_view();
    if (!text || !load_uri(*text, *uri, owned_[index])) return false;
    bytes = owned_[index];
  } else if (index == 0 && glb_chunk_) {
    bytes = *glb_chunk_;
  } else {
    return at.fail(ImportErrorCode::kMissingField, "the buffer has no uri");
  }
  if (at.diagnostics().failed()) return false;
  if (bytes.size() < claimed) {
    return at.fail(ImportErrorCode::kBufferOutOfRange,
                   "the buffer should have " + std::to_string(claimed) + " bytes, but there are " +
                       std::to_string(bytes.size()));
  }
  total_bytes_ += bytes.size();
  if (total_bytes_ > at.diagnostics().limits().max_buffer_bytes) {
    return at.fail(ImportErrorCode::kLimitExceeded, "the buffers are too large together");
  }
  loaded_[index] = bytes.substr(0, static_cast<std::size_t>(claimed));
  return true;
}

std::optional<std::string_view> GltfBuffers::buffer(std::uint64_t index, const JsonAt& at) {
  if (index >= loaded_.size()) {
    at.fail(ImportErrorCode::kIndexOutOfRange, "there is no buffer " + std::to_string(index));
    return std::nullopt;
  }
  const auto i = static_cast<std::size_t>(index);
  if (!loaded_[i] && !load(i, at)) return std::nullopt;
  return loaded_[i];
}

std::optional<std::string_view> GltfBuffers::view(std::uint64_t index, const JsonAt& at) {
  if (!views_ || index >= views_->size()) {
    at.fail(ImportErrorCode::kIndexOutOfRange, "there is no buffer view " + std::to_string(index));
    return std::nullopt;
  }
  const JsonAt found = views_->element(static_cast<std::size_t>(index));
  if (!found.expect_object()) return std::nullopt;
  if (!found.has("buffer") || !found.has("byteLength")) {
    found.fail(ImportErrorCode::kMissingField, "a buffer view needs buffer and byteLength");
    return std::nullopt;
  }
  const std::uint64_t offset = found.integer_or("byteOffset", 0);
  const std::uint64_t length = found.integer_or("byteLength", 0);
  const std::uint64_t step = found.integer_or("byteStride", 0);
  const std::uint64_t owner = found.integer_or("buffer", 0);
  if (found.diagnostics().failed()) return std::nullopt;
  const auto bytes = buffer(owner, found);
  if (!bytes) return std::nullopt;
  if (offset > bytes->size() || length > bytes->size() - offset || step > 252) {
    found.fail(ImportErrorCode::kBufferOutOfRange,
               "the view (" + std::to_string(offset) + " + " + std::to_string(length) +
                   " bytes) does not fit into its buffer of " + std::to_string(bytes->size()));
    return std::nullopt;
  }
  return bytes->substr(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
}

std::uint64_t GltfBuffers::stride(std::uint64_t index) const {
  return views_->element(static_cast<std::size_t>(index)).integer_or("byteStride", 0);
}

}  // namespace raykiln::render::io
