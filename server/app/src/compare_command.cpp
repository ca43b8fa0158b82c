#include <iostream>

#include "input_file.hpp"
#include "output_file.hpp"
#include "raykiln/app/cli.hpp"
#include "raykiln/app/comparison.hpp"
#include "raykiln/image/encode.hpp"

namespace raykiln::server {
namespace {

constexpr std::uint64_t kMostBytes = std::uint64_t{4} << 30U;

bool write(const std::filesystem::path& path, const std::vector<std::uint8_t>& bytes) {
  if (path.empty()) return true;
  if (bytes.empty()) {
    std::cerr << "raykiln: " << path.string() << ": there is no such map without noise in both pictures\n";
    return true;
  }
  const auto error = write_whole_file(path, std::string(bytes.begin(), bytes.end()));
  if (error) std::cerr << "raykiln: " << *error << '\n';
  return !error;
}

}  // namespace

ExitCode compare_command(const CliOptions& options) {
  render::set_image_library_threads(1);
  const CompareOptions& wanted = options.compare;
  std::vector<std::vector<std::uint8_t>> files;
  for (const auto& path : {wanted.render, wanted.reference}) {
    auto bytes = read_whole_file(path, kMostBytes);
    if (!bytes) {
      std::cerr << "raykiln: " << path.string() << ": " << bytes.error().message << '\n';
      return ExitCode::kScene;
    }
    files.push_back(std::move(*bytes));
  }
  const bool with_pictures = !wanted.difference.empty() || !wanted.z_map.empty();
  const Comparison comparison = compare_pictures(files[0], files[1], wanted.settings, with_pictures);
  if (options.json) {
    std::cout << comparison_json(comparison) << '\n';
  } else if (!options.quiet || comparison.differs) {
    std::cout << comparison_text(comparison);
  }
  const bool written = comparison.method == ComparisonMethod::kNone ||
                       (write(wanted.difference, comparison.difference_png) &&
                        write(wanted.z_map, comparison.z_map_png));
  if (!written) return ExitCode::kFailure;
  if (comparison.unreadable) return ExitCode::kScene;
  return comparison.differs ? ExitCode::kImageDiffers : ExitCode::kOk;
}

}  // namespace raykiln::server
