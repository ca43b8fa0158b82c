#include "glb_container.hpp"

#include <cstdint>
#include <cstring>

namespace raykiln::render::io {
namespace {

constexpr std::uint32_t kMagic = 0x46546C67;   // "glTF"
constexpr std::uint32_t kJson = 0x4E4F534A;    // "JSON"
constexpr std::uint32_t kBinary = 0x004E4942;  // "BIN\0"
constexpr std::size_t kHeaderBytes = 12;
constexpr std::size_t kChunkHeaderBytes = 8;

std::uint32_t word(std::string_view bytes, std::size_t offset) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

}  // namespace

std::optional<GlbChunks> split_glb(std::string_view bytes, const std::string& name,
                                   Diagnostics& diagnostics) {
  const auto damaged = [&](const std::string& message, std::size_t at) {
    diagnostics.fail(ImportErrorCode::kInvalidGlb, message, name, "byte " + std::to_string(at));
    return std::nullopt;
  };
  if (bytes.size() < kHeaderBytes || word(bytes, 0) != kMagic) {
    return damaged("the file does not begin with a GLB header", 0);
  }
  if (word(bytes, 4) != 2) {
    diagnostics.fail(ImportErrorCode::kUnsupportedVersion,
                     "GLB version " + std::to_string(word(bytes, 4)) + " is not supported, only 2 is",
                     name, "byte 4", "convert the file to glTF 2.0");
    return std::nullopt;
  }
  const std::size_t claimed = word(bytes, 8);
  if (claimed < kHeaderBytes || claimed > bytes.size()) {
    return damaged("the header promises " + std::to_string(claimed) + " bytes, the file has " +
                       std::to_string(bytes.size()),
                   8);
  }
  bytes = bytes.substr(0, claimed);
  GlbChunks chunks;
  std::size_t at = kHeaderBytes;
  while (bytes.size() - at >= kChunkHeaderBytes) {
    const std::size_t length = word(bytes, at);
    const std::uint32_t type = word(bytes, at + 4);
    const std::size_t begin = at + kChunkHeaderBytes;
    if (length > bytes.size() - begin) return damaged("a chunk reaches beyond the file", at);
    const std::string_view chunk = bytes.substr(begin, length);
    if (at == kHeaderBytes && type != kJson) return damaged("the first chunk is not JSON", at);
    if (type == kJson && chunks.json.data() == nullptr) chunks.json = chunk;
    if (type == kBinary && !chunks.binary) chunks.binary = chunk;
    at = begin + length;
  }
  if (chunks.json.data() == nullptr) return damaged("there is no JSON chunk", at);
  return chunks;
}

}  // namespace raykiln::render::io
