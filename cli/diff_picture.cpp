// What a picture of a difference becomes in a format that holds no negative numbers.

#include "diff_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace brume::cli {
namespace {

bool is_color(const Channel& c) { return c.name != "A"; }

// Alpha's difference, 0 as a rule, would make all else transparent.
void leave_out_alpha(Image& image) {
  for (std::size_t k = image.planes.size(); k-- > 0 && image.planes.size() > 1;)
    if (!is_color(image.header.channels[k])) {
      image.header.channels.erase(image.header.channels.begin() + std::ptrdiff_t(k));
      image.planes.erase(image.planes.begin() + std::ptrdiff_t(k));
    }
}

bool is_picture(const Channel& c) {
  return c.name == "R" || c.name == "G" || c.name == "B" || c.name == "Y";
}

}  // namespace

bool keeps_numbers(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), ::tolower);
  return extension == ".exr" || extension == ".tif" || extension == ".tiff";
}

void draw_for_eyes(Image& image, bool is_signed) {
  leave_out_alpha(image);
  if (!is_signed) return;
  const auto& channels = image.header.channels;
  const bool rgb = std::any_of(channels.begin(), channels.end(), is_picture);
  float most = std::numeric_limits<float>::min();
  for (std::size_t k = 0; k < channels.size(); ++k)
    for (const float d : image.planes[k])
      if ((!rgb || is_picture(channels[k])) && std::isfinite(d))
        most = std::max(most, std::abs(d));
  for (auto& plane : image.planes)
    for (float& d : plane)
      d = std::isnan(d) ? 1 : std::clamp(0.5f + 0.5f * (d / most), 0.f, 1.f);
}

}  // namespace brume::cli
