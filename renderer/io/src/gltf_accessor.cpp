#include "gltf_accessor.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>

namespace raykiln::render::io {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF buffers are little-endian");

// Component types of glTF 2.0, section 3.6.2.2.
constexpr std::uint64_t kInt8 = 5120;
constexpr std::uint64_t kUint8 = 5121;
constexpr std::uint64_t kInt16 = 5122;
constexpr std::uint64_t kUint16 = 5123;
constexpr std::uint64_t kUint32 = 5125;
constexpr std::uint64_t kFloat = 5126;
constexpr std::uint64_t kItemsPerPoll = 1 << 16;
constexpr std::uint64_t kFreeZeros = 1 << 16;  // elements without bytes that sparse may fill

std::size_t component_bytes(std::uint64_t type) {
  switch (type) {
    case kInt8:
    case kUint8: return 1;
    case kInt16:
    case kUint16: return 2;
    case kUint32:
    case kFloat: return 4;
    default: return 0;
  }
}

template <typename T>
T load(const char* from) {
  T value;
  std::memcpy(&value, from, sizeof(T));
  return value;
}

template <typename T>
double integer_component(const char* from, bool normalized, double largest) {
  const double value = static_cast<double>(load<T>(from));
  return normalized ? std::max(value / largest, -1.0) : value;
}

double component(const char* from, std::uint64_t type, bool normalized) {
  switch (type) {
    case kInt8: return integer_component<std::int8_t>(from, normalized, 127.0);
    case kUint8: return integer_component<std::uint8_t>(from, normalized, 255.0);
    case kInt16: return integer_component<std::int16_t>(from, normalized, 32767.0);
    case kUint16: return integer_component<std::uint16_t>(from, normalized, 65535.0);
    case kUint32: return integer_component<std::uint32_t>(from, normalized, 4294967295.0);
    default: return static_cast<double>(load<float>(from));
  }
}

std::uint32_t index_component(const char* from, std::uint64_t type) {
  if (type == kUint8) return load<std::uint8_t>(from);
  if (type == kUint16) return load<std::uint16_t>(from);
  return load<std::uint32_t>(from);
}

bool is_index_type(std::uint64_t type) {
  return type == kUint8 || type == kUint16 || type == kUint32;
}

bool finite(const Vec3d& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace

GltfAccessors::GltfAccessors(JsonAt root, GltfBuffers& buffers)
    : accessors_(root.array("accessors")), buffers_(&buffers) {}

std::optional<JsonAt> GltfAccessors::accessor(std::uint64_t index, const JsonAt& at) {
  if (!accessors_ || index >= accessors_->size()) {
    at.fail(ImportErrorCode::kIndexOutOfRange, "there is no accessor " + std::to_string(index));
    return std::nullopt;
  }
  JsonAt found = accessors_->element(static_cast<std::size_t>(index));
  if (!found.expect_object()) return std::nullopt;
  return found;
}

std::optional<std::uint64_t> GltfAccessors::count(std::uint64_t index, const JsonAt& at) {
  const auto found = accessor(index, at);
  if (!found) return std::nullopt;
  if (!found->has("count")) {
    found->fail(ImportErrorCode::kMissingField, "the accessor has no count");
    return std::nullopt;
  }
  return found->member("count").integer();
}

bool GltfAccessors::has_bytes(std::uint64_t index, const JsonAt& at) {
  const auto found = accessor(index, at);
  return found && (found->has("bufferView") || found->has("sparse"));
}

const char* GltfAccessors::place(std::uint64_t view, std::uint64_t offset, std::uint64_t count,
                                 std::size_t size, std::size_t& stride, const JsonAt& at) {
  const auto bytes = buffers_->view(view, at);
  if (!bytes) return nullptr;
  const std::uint64_t step = buffers_->stride(view);
  stride = step == 0 ? size : static_cast<std::size_t>(step);
  const bool fits = stride >= size && offset <= bytes->size() && size <= bytes->size() - offset &&
                    (count - 1) <= (bytes->size() - offset - size) / stride;
  if (fits) return bytes->data() + offset;
  at.fail(ImportErrorCode::kBufferOutOfRange,
          std::to_string(count) + " elements of " + std::to_string(size) +
              " bytes do not fit into buffer view " + std::to_string(view) + " of " +
              std::to_string(bytes->size()) + " bytes");
  return nullptr;
}

std::optional<GltfAccessors::Layout> GltfAccessors::layout(const JsonAt& at, std::string_view type,
                                                           std::size_t components) {
  Layout result;
  result.count = at.integer_or("count", 0);
  result.component_type = at.integer_or("componentType", 0);
  result.normalized = at.flag_or("normalized", false);
  const std::string found_type = at.text_or("type", "");
  const std::uint64_t offset = at.integer_or("byteOffset", 0);
  if (at.diagnostics().failed()) return std::nullopt;
  const std::size_t bytes = component_bytes(result.component_type);
  if (bytes == 0 || found_type != type) {
    at.fail(ImportErrorCode::kInvalidValue,
            "an accessor of type " + std::string(type) + " is needed here, this one is " +
                in_quotes(found_type) + " of component type " +
                std::to_string(result.component_type));
    return std::nullopt;
  }
  if (result.count == 0 || !at.has("bufferView")) return result;
  const std::uint64_t view = at.integer_or("bufferView", 0);
  if (at.diagnostics().failed()) return std::nullopt;
  result.data = place(view, offset, result.count, bytes * components, result.stride, at);
  if (result.data == nullptr) return std::nullopt;
  return result;
}

std::optional<std::vector<Vec3d>> GltfAccessors::vectors(std::uint64_t index, const JsonAt& at,
                                                         int components) {
  const auto found = accessor(index, at);
  const auto place_of = found ? layout(*found, components == 3 ? "VEC3" : "VEC2",
                                               static_cast<std::size_t>(components)) : std::nullopt;
  if (!place_of) return std::nullopt;
  if (place_of->data == nullptr && place_of->count > kFreeZeros) {
    found->fail(ImportErrorCode::kLimitExceeded, "the accessor has a large count but no buffer view");
    return std::nullopt;
  }
  std::vector<Vec3d> values(static_cast<std::size_t>(place_of->count), Vec3d(0.0));
  const std::size_t bytes = component_bytes(place_of->component_type);
  for (std::size_t i = 0; place_of->data != nullptr && i < values.size(); ++i) {
    if (i % kItemsPerPoll == 0 && !at.diagnostics().may_go_on()) return std::nullopt;
    const char* from = place_of->data + i * place_of->stride;
    for (int axis = 0; axis < components; ++axis) {
      values[i][axis] = component(from + static_cast<std::size_t>(axis) * bytes,
                                  place_of->component_type, place_of->normalized);
    }
  }
  if (found->has("sparse") && !apply_sparse(*found, *place_of, components, values)) return std::nullopt;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (finite(values[i])) continue;
    found->fail(ImportErrorCode::kNotFinite, "element " + std::to_string(i) + " is not finite",
                "remove NaN and infinite numbers");
    return std::nullopt;
  }
  return values;
}

bool GltfAccessors::apply_sparse(const JsonAt& accessor, const Layout& base, int components,
                                 std::vector<Vec3d>& values) {
  const auto sparse = accessor.object("sparse");
  if (!sparse) return false;
  const std::uint64_t count = sparse->integer_or("count", 0);
  const auto where = sparse->object("indices");
  const auto what = sparse->object("values");
  if (accessor.diagnostics().failed()) return false;
  if (!where || !what || count == 0 || count > values.size()) {
    return sparse->fail(ImportErrorCode::kInvalidValue,
                        "sparse needs indices, values and a count that fits");
  }
  const std::uint64_t index_type = where->integer_or("componentType", 0);
  const std::size_t bytes = component_bytes(base.component_type);
  std::size_t index_stride = 0;
  std::size_t value_stride = 0;
  if (!is_index_type(index_type)) {
    return where->fail(ImportErrorCode::kInvalidValue, "indices have an unsigned integer type");
  }
  const std::uint64_t index_view = where->integer_or("bufferView", ~std::uint64_t{0});
  const std::uint64_t value_view = what->integer_or("bufferView", ~std::uint64_t{0});
  const std::uint64_t index_offset = where->integer_or("byteOffset", 0);
  const std::uint64_t value_offset = what->integer_or("byteOffset", 0);
  if (accessor.diagnostics().failed()) return false;
  const char* index_data = place(index_view, index_offset, count, component_bytes(index_type),
                                 index_stride, *where);
  if (index_data == nullptr) return false;
  const char* value_data = place(value_view, value_offset, count, bytes * static_cast<std::size_t>(components),
                                 value_stride, *what);
  if (value_data == nullptr) return false;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t target = index_component(index_data + i * index_stride, index_type);
    if (target >= values.size()) {
      return where->fail(ImportErrorCode::kIndexOutOfRange,
                         "sparse index " + std::to_string(target) + " is out of range");
    }
    for (int axis = 0; axis < components; ++axis) {
      values[target][axis] =
          component(value_data + i * value_stride + static_cast<std::size_t>(axis) * bytes,
                    base.component_type, base.normalized);
    }
  }
  return true;
}

std::optional<std::vector<std::uint32_t>> GltfAccessors::indices(std::uint64_t index,
                                                                 const JsonAt& at) {
  const auto found = accessor(index, at);
  const auto place_of = found ? layout(*found, "SCALAR", 1) : std::nullopt;
  if (!place_of) return std::nullopt;
  if (!is_index_type(place_of->component_type)) {
    found->fail(ImportErrorCode::kInvalidValue, "indices have an unsigned integer type");
    return std::nullopt;
  }
  if (place_of->count > 0 && (place_of->data == nullptr || found->has("sparse"))) {
    found->fail(ImportErrorCode::kInvalidValue, "indices need a buffer view and no sparse part");
    return std::nullopt;
  }
  std::vector<std::uint32_t> values(static_cast<std::size_t>(place_of->count));
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = index_component(place_of->data + i * place_of->stride, place_of->component_type);
  }
  return values;
}

}  // namespace raykiln::render::io
