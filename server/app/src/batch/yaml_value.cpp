// The one place that uses yaml-cpp.
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <optional>
#include <set>

#include "value.hpp"

namespace raykiln::server {
namespace {

constexpr int kMostLevels = 64;

Error invalid(const std::string& why, int line) {
  return {ErrorKind::kInvalid, "invalid_file", why, line > 0 ? "line " + std::to_string(line) : ""};
}

class Converter {
 public:
  explicit Converter(const DocumentBounds& bounds) : bounds_(bounds), most_text_(4 * bounds.bytes) {}
  Value convert(const YAML::Node& node, int level) {
    Value value;
    value.line = node.Mark().line + 1;
    if (++nodes_ > bounds_.nodes || level > kMostLevels) fail("the file is too deep or too large", value.line);
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
      std::set<std::string> keys;
      for (const auto& entry : node) add(value, keys, entry.first, entry.second, level);
    }
    return value;
  }
  [[nodiscard]] const std::optional<Error>& fault() const { return fault_; }

 private:
  void add(Value& map, std::set<std::string>& keys, const YAML::Node& key, const YAML::Node& item, int level) {
    if (fault_) return;
    if (!key.IsScalar()) return fail("a key must be text", key.Mark().line + 1);
    if (!has_room(key, key.Mark().line + 1)) return;
    if (!keys.insert(key.Scalar()).second) {
      return fail("the key \"" + key.Scalar() + "\" is there twice", key.Mark().line + 1);
    }
    map.map.emplace_back(key.Scalar(), convert(item, level + 1));
  }
  /// A short file may repeat a long text by many aliases.
  bool has_room(const YAML::Node& text, int line) {
    text_ += text.Scalar().size();
    if (text_ > most_text_) fail("the file is too large with its aliases written out", line);
    return text_ <= most_text_;
  }
  void fail(const std::string& why, int line) {
    if (!fault_) fault_ = invalid(why, line);
  }

  const DocumentBounds& bounds_;
  const std::size_t most_text_;  ///< of all keys and values
  int nodes_ = 0;
  std::size_t text_ = 0;
  std::optional<Error> fault_;
};

/// The parser builds nodes, each of some hundred bytes, before anyone can count them; there are no more than marks.
bool may_have_too_many_nodes(std::string_view text, const DocumentBounds& bounds) {
  const auto marks = std::count_if(text.begin(), text.end(), [](char c) {
    return c == ',' || c == ':' || c == '[' || c == '{' || c == '-' || c == '?' || c == '*';
  });
  constexpr int kMarksANode = 4;
  return marks > kMarksANode * std::ptrdiff_t{bounds.nodes};
}

}  // namespace

Result<Value> parse_yaml(std::string_view text, const DocumentBounds& bounds) {
  if (text.size() > bounds.bytes) {
    return invalid("the file is larger than " + std::to_string(bounds.bytes >> 20U) + " MiB", 0);
  }
  if (may_have_too_many_nodes(text, bounds)) return invalid("the file is too deep or too large", 0);
  try {
    Converter converter(bounds);
    Value value = converter.convert(YAML::Load(std::string(text)), 0);
    if (converter.fault()) return *converter.fault();
    return value;
  } catch (const YAML::Exception& fault) {
    return invalid(fault.msg, fault.mark.line + 1);
  }
}

}  // namespace raykiln::server
