// The one place that uses yaml-cpp.
#include <yaml-cpp/yaml.h>

#include <optional>

#include "value.hpp"

namespace raykiln::server {
namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 20U;
constexpr int kMostLevels = 64;
constexpr int kMostNodes = 100'000;
constexpr std::size_t kMostText = 4 * kMostBytes;  ///< of all keys and values, aliases written out

Error invalid(const std::string& why, int line) {
  return {ErrorKind::kInvalid, "invalid_file", why, line > 0 ? "line " + std::to_string(line) : ""};
}

class Converter {
 public:
  Value convert(const YAML::Node& node, int level) {
    Value value;
    value.line = node.Mark().line + 1;
    if (++nodes_ > kMostNodes || level > kMostLevels) fail("the file is too deep or too large", value.line);
    if (fault_) return value;
    if (node.IsScalar()) {
      value.kind = Value::Kind::kScalar;
      if (!has_room(node, value.line)) return value;
      value.text = node.Scalar();
      value.quoted = node.Tag() == "!";
    } else if (node.IsSequence()) {
      value.kind = Value::Kind::kList;
      for (const auto& item : node) value.list.push_back(convert(item, level + 1));
    } else if (node.IsMap()) {
      value.kind = Value::Kind::kMap;
      for (const auto& entry : node) add(value, entry.first, entry.second, level);
    }
    return value;
  }
  [[nodiscard]] const std::optional<Error>& fault() const { return fault_; }

 private:
  void add(Value& map, const YAML::Node& key, const YAML::Node& item, int level) {
    if (!key.IsScalar()) return fail("a key must be text", key.Mark().line + 1);
    if (!has_room(key, key.Mark().line + 1)) return;
    if (map.find(key.Scalar()) != nullptr) {
      return fail("the key \"" + key.Scalar() + "\" is there twice", key.Mark().line + 1);
    }
    map.map.emplace_back(key.Scalar(), convert(item, level + 1));
  }
  /// A short file may repeat a long text by many aliases.
  bool has_room(const YAML::Node& text, int line) {
    text_ += text.Scalar().size();
    if (text_ > kMostText) fail("the file is too large with its aliases written out", line);
    return text_ <= kMostText;
  }
  void fail(const std::string& why, int line) {
    if (!fault_) fault_ = invalid(why, line);
  }

  int nodes_ = 0;
  std::size_t text_ = 0;
  std::optional<Error> fault_;
};

}  // namespace

Result<Value> parse_yaml(std::string_view text) {
  if (text.size() > kMostBytes) return invalid("the file is larger than 1 MiB", 0);
  try {
    Converter converter;
    Value value = converter.convert(YAML::Load(std::string(text)), 0);
    if (converter.fault()) return *converter.fault();
    return value;
  } catch (const YAML::Exception& fault) {
    return invalid(fault.msg, fault.mark.line + 1);
  }
}

}  // namespace raykiln::server
