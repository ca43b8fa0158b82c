#include "batch_judge.hpp"

#include <cmath>

#include "../input_file.hpp"
#include "../output_file.hpp"
#include "raykiln/image/decode.hpp"
#include "raykiln/image/encode.hpp"

namespace raykiln::server {
namespace {

constexpr std::uint64_t kMostBytes = std::uint64_t{4} << 30U;
using Bytes = std::vector<std::uint8_t>;

Status write(const std::filesystem::path& path, const Bytes& bytes) {
  const auto error = write_whole_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  if (!error) return success();
  return Error{ErrorKind::kInternal, "internal", *error, ""};
}

/// Root of the mean over pixels and channels of e^2 / (m^2 + 0.01 M^2), e the standard error of the mean m
/// and M the mean of the picture: an estimate of its relative error.
std::optional<double> relative_error(const render::DecodedImage& picture) {
  if (picture.error.size() != picture.image.rgb.size() || picture.error.empty()) return std::nullopt;
  double mean = 0.0, sum = 0.0, count = 0.0;
  for (const float value : picture.image.rgb) mean += static_cast<double>(value);
  mean /= static_cast<double>(picture.image.rgb.size());
  for (std::size_t i = 0; i < picture.error.size(); ++i) {
    const double m = static_cast<double>(picture.image.rgb[i]), e = static_cast<double>(picture.error[i]);
    const double below = m * m + 0.01 * mean * mean;
    if (!std::isfinite(e) || !std::isfinite(m) || !(below > 0.0)) continue;
    sum += e * e / below;
    count += 1.0;
  }
  if (!(count > 0.0)) return std::nullopt;
  return std::sqrt(sum / count);
}

/// What a browser can show of an EXR or PNG; empty when it is neither.
Bytes as_png(const Bytes& bytes) {
  auto decoded = render::decode_image(bytes);
  const auto* picture = std::get_if<render::DecodedImage>(&decoded);
  if (picture == nullptr) return {};
  if (picture->display) return bytes;
  auto encoded = render::encode_png(picture->image, 0.0);
  auto* png = std::get_if<render::Bytes>(&encoded);
  return png != nullptr ? std::move(*png) : Bytes{};
}

Status show_picture(const PlannedPicture& planned, const Bytes& exr, const std::filesystem::path& folder,
                    PictureResult& result) {
  if (auto written = write(folder / picture_file(planned.name, ".exr"), exr); !written) return written;
  auto decoded = render::decode_image(exr);
  if (const auto* picture = std::get_if<render::DecodedImage>(&decoded)) {
    result.error_reached = relative_error(*picture);
  }
  return write(folder / picture_file(planned.name, ".png"), as_png(exr));
}

}  // namespace

Status judge_picture(const BatchPlan& plan, const PlannedPicture& planned, const Bytes& exr,
                     const std::filesystem::path& folder, PictureResult& result) {
  std::error_code error;
  std::filesystem::create_directories(folder / "pictures", error);
  if (error) return Error{ErrorKind::kInternal, "internal", error.message(), folder.string()};
  if (auto shown = show_picture(planned, exr, folder, result); !shown) return shown;
  if (planned.reference.empty()) return success();
  const auto reference = read_whole_file(planned.reference, kMostBytes);
  if (!reference) {
    result.reference_missing = true;
    return success();
  }
  Comparison comparison = compare_pictures(exr, *reference, plan.comparison, true);
  for (const auto& [ending, bytes] : {std::pair{".reference.png", as_png(*reference)},
                                      {".difference.png", std::move(comparison.difference_png)},
                                      {".z.png", std::move(comparison.z_map_png)}}) {
    if (bytes.empty()) continue;
    if (auto written = write(folder / picture_file(planned.name, ending), bytes); !written) return written;
  }
  comparison.difference_png.clear();
  comparison.z_map_png.clear();
  result.comparison = std::move(comparison);
  return success();
}

}  // namespace raykiln::server
