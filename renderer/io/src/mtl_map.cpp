#include "mtl_map.hpp"

#include <array>
#include <cmath>

#include "text_numbers.hpp"

namespace raykiln::render::io {
namespace {

struct Option {
  std::string_view word;
  int words;  ///< that follow it
};
constexpr std::array<Option, 10> kPassedOver{{{"-blendu", 1},
                                              {"-blendv", 1},
                                              {"-boost", 1},
                                              {"-bm", 1},
                                              {"-cc", 1},
                                              {"-imfchan", 1},
                                              {"-mm", 2},
                                              {"-texres", 1},
                                              {"-type", 1},
                                              {"-colorspace", 1}}};
constexpr double kLargest = 1e6;

/// One to three numbers; the third, for depth, is of no use here.
void take_pair(std::string_view& text, double& u, double& v) {
  double unused = 0.0;
  for (double* value : {&u, &v, &unused}) {
    std::string_view rest = text;
    double number = 0.0;
    if (take_number(rest, number) != NumberStatus::kOk) return;
    if (!(rest.empty() || rest[0] == ' ' || rest[0] == '\t')) return;  // "2.png"
    if (trimmed(rest).empty()) return;  // a name that is a number
    if (std::abs(number) <= kLargest) *value = number;
    text = rest;
  }
}

}  // namespace

// In the file v counts upwards: with v_up' = s v_up + o, 1 - v_up' = s (1 - v_up) + (1 - s - o).
MtlMap read_mtl_map(std::string_view text) {
  MtlMap map;
  double scale_u = 1.0, scale_v = 1.0, offset_u = 0.0, offset_v = 0.0;
  while (true) {
    skip_spaces(text);
    std::string_view rest = text;
    const std::string_view word = take_word(rest);
    if (!word.starts_with('-')) break;
    if (word == "-s" || word == "-o") {
      take_pair(rest, word == "-s" ? scale_u : offset_u, word == "-s" ? scale_v : offset_v);
    } else if (word == "-clamp") {
      if (take_word(rest) == "on") map.use.wrap_u = map.use.wrap_v = TextureWrap::kClamp;
    } else if (word == "-t") {
      double u = 0.0, v = 0.0;
      take_pair(rest, u, v);
      map.ignored.emplace_back(word);
    } else {
      const Option* known = nullptr;
      for (const Option& option : kPassedOver) {
        if (option.word == word) known = &option;
      }
      if (known == nullptr) break;  // a file name may begin with a minus
      for (int i = 0; i < known->words; ++i) (void)take_word(rest);
      map.ignored.emplace_back(word);
    }
    text = rest;
  }
  map.file = std::string(trimmed(text));
  map.use.u_row = {scale_u, 0.0, offset_u};
  map.use.v_row = {0.0, scale_v, 1.0 - scale_v - offset_v};
  return map;
}

}  // namespace raykiln::render::io
