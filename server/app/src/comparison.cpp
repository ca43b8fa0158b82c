#include "raykiln/app/comparison.hpp"

#include <algorithm>

#include "raykiln/compare/maps.hpp"
#include "raykiln/image/decode.hpp"
#include "raykiln/image/encode.hpp"
#include "text_format.hpp"

namespace raykiln::server {
namespace {

using render::DecodedImage;

std::optional<DecodedImage> read(PictureBytes bytes, const char* which, Comparison& comparison) {
  auto decoded = render::decode_image(bytes);
  if (auto* image = std::get_if<DecodedImage>(&decoded)) return std::move(*image);
  comparison.unreadable = true;
  comparison.reason = std::string("the ") + which + " cannot be read: " +
                      std::get<render::DecodeError>(decoded).message;
  return std::nullopt;
}

bool says_the_same(const DecodedImage& a, const DecodedImage& b, const std::string& attribute) {
  const auto one = a.attributes.find(attribute), other = b.attributes.find(attribute);
  return one != a.attributes.end() && other != b.attributes.end() && one->second == other->second;
}

render::MeasuredImage measured(DecodedImage& decoded) {
  return {.mean = std::move(decoded.image),
          .error = std::move(decoded.error),
          .samples = std::move(decoded.samples)};
}

std::vector<std::uint8_t> png(const render::Image& picture) {
  auto encoded = render::encode_png(picture, 0.0);
  auto* bytes = std::get_if<render::Bytes>(&encoded);
  return bytes != nullptr ? std::move(*bytes) : std::vector<std::uint8_t>{};
}

std::string place(const render::PixelRect& r) {
  return std::to_string(r.width()) + " x " + std::to_string(r.height()) + " pixels at (" +
         std::to_string(r.x0) + ", " + std::to_string(r.y0) + ")";
}

std::string noise_reason(const render::NoiseVerdict& verdict) {
  using Kind = render::EvidenceKind;
  if (!verdict.differs) return "the difference is within the noise";
  if (verdict.render_not_finite != verdict.reference_not_finite) {
    return "pixels that are not finite: " + std::to_string(verdict.render_not_finite) + " against " +
           std::to_string(verdict.reference_not_finite) + " in the reference";
  }
  // A place says more than that there is structure.
  const bool placed = verdict.strongest.kind == Kind::kStructure && !verdict.regions.empty();
  const render::Evidence& best = placed ? verdict.regions.front() : verdict.strongest;
  const std::string clear = " (z " + short_number(best.z) + ")";
  switch (best.kind) {
    case Kind::kStructure: return "neighbouring pixels differ together" + clear;
    case Kind::kWhole: return "the whole picture is " + std::string(best.z > 0 ? "brighter" : "darker") + clear;
    case Kind::kNone: return "pixels that are not finite are not the same";
    case Kind::kPixel:
    case Kind::kBlock: break;
  }
  return place(best.where) + (best.z > 0 ? " are brighter" : " are darker") + clear;
}

void by_noise(DecodedImage& a, DecodedImage& b, bool with_pictures, Comparison& comparison) {
  const auto render = measured(a), reference = measured(b);
  comparison.method = ComparisonMethod::kNoise;
  comparison.noise = render::test_noise(render, reference, comparison.settings.noise);
  comparison.differs = comparison.noise.differs;
  comparison.reason = noise_reason(comparison.noise);
  if (!with_pictures) return;
  comparison.difference_png = png(render::difference_picture(render.mean, reference.mean));
  comparison.z_map_png = png(render::z_map(render, reference));
}

void by_thresholds(const DecodedImage& a, const DecodedImage& b, bool with_pictures, Comparison& comparison) {
  comparison.method = ComparisonMethod::kThresholds;
  comparison.thresholds = render::test_thresholds(a.image, b.image, comparison.settings.thresholds);
  comparison.differs = comparison.thresholds.differs;
  comparison.reason = short_number(100.0 * comparison.thresholds.failing_share) +
                      " % of the pixels are beyond the thresholds, noise not taken into account";
  if (with_pictures) comparison.difference_png = png(render::difference_picture(a.image, b.image));
}

}  // namespace

const char* name(ComparisonMethod method) {
  if (method == ComparisonMethod::kNoise) return "noise";
  return method == ComparisonMethod::kThresholds ? "thresholds" : "none";
}

Comparison compare_pictures(PictureBytes render_bytes, PictureBytes reference_bytes,
                            const ComparisonSettings& settings, bool with_pictures) {
  Comparison comparison;
  comparison.settings = settings;
  auto a = read(render_bytes, "render", comparison);
  if (!a) return comparison;
  auto b = read(reference_bytes, "reference", comparison);
  if (!b) return comparison;
  comparison.width = a->image.width;
  comparison.height = a->image.height;
  if (a->image.width != b->image.width || a->image.height != b->image.height) {
    comparison.reason = "the sizes differ: " + std::to_string(a->image.width) + " x " +
                        std::to_string(a->image.height) + " against " + std::to_string(b->image.width) +
                        " x " + std::to_string(b->image.height) + " of the reference";
    return comparison;
  }
  comparison.same_seed = says_the_same(*a, *b, "raykiln:seed");
  comparison.display_values = a->display || b->display;
  if (comparison.display_values) {
    for (DecodedImage* one : {&*a, &*b}) {
      if (!one->display) one->image = render::display_values(one->image, 0.0);
    }
  }
  comparison.figures = render::difference_figures(a->image, b->image);
  const auto has_noise = [](const DecodedImage& image) { return !image.error.empty() && !image.samples.empty(); };
  const bool noise_known = has_noise(*a) && has_noise(*b) && !comparison.display_values;
  if (noise_known && !settings.use_thresholds) {
    by_noise(*a, *b, with_pictures, comparison);
  } else {
    by_thresholds(*a, *b, with_pictures, comparison);
  }
  return comparison;
}

}  // namespace raykiln::server
