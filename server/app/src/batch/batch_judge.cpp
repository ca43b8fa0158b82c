#include "batch_judge.hpp"

#include <new>

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

Status show_picture(const PlannedPicture& planned, const Bytes& exr, const std::filesystem::path& folder) {
  if (auto written = write(folder / picture_file(planned.name, ".exr"), exr); !written) return written;
  return write(folder / picture_file(planned.name, ".png"), as_png(exr));
}

/// A reference that is there and cannot be read is no difference, and nothing to approve.
void fail(PictureResult& result, const PlannedPicture& planned, const std::string& why) {
  result.state = PictureState::kFailed;
  result.failure = "reference_unreadable: " + why + " (" + planned.reference.string() + ")";
}

Status judge(const BatchPlan& plan, const PlannedPicture& planned, const Bytes& exr, const std::filesystem::path& folder,
             PictureResult& result) {
  std::error_code error;
  std::filesystem::create_directories(folder / "pictures", error);
  if (error) return Error{ErrorKind::kInternal, "internal", error.message(), folder.string()};
  if (auto shown = show_picture(planned, exr, folder); !shown) return shown;
  if (planned.reference.empty()) return success();
  const auto reference = read_whole_file(planned.reference, kMostBytes);
  if (!reference) {
    result.reference_missing = !std::filesystem::exists(planned.reference, error) && !error;
    if (!result.reference_missing) fail(result, planned, reference.error().message);
    return success();
  }
  Comparison comparison = compare_pictures(exr, *reference, plan.comparison, true);
  if (comparison.unreadable) {
    fail(result, planned, comparison.reason);
    return success();
  }
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

}  // namespace

std::string failure_text(const Error& error) {
  return error.code + ": " + error.message + (error.where.empty() ? "" : " (" + error.where + ")");
}

Status judge_render(const BatchPlan& plan, const PlannedPicture& planned, const Bytes& exr,
                    const std::filesystem::path& folder, PictureResult& result) {
  try {
    return judge(plan, planned, exr, folder, result);
  } catch (const std::bad_alloc&) {  // of one that is too large; the other pictures have room
    result.state = PictureState::kFailed;
    result.failure = "internal: out of memory";
    return success();
  }
}

}  // namespace raykiln::server
