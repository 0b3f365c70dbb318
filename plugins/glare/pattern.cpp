// Patterns by name; an image as one.

#include <ImfArray.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include "kernel.h"

namespace brume::glare {
namespace {

struct Picture {
  int width = 0, height = 0;
  std::vector<float> planes[3];

  /// Between samples, 0 outside; finite and not negative.
  double at(std::size_t c, double x, double y) const {
    const double fx = std::floor(x), fy = std::floor(y);
    const auto sample = [&](double i, double j) -> double {
      if (!(i >= 0 && i < width && j >= 0 && j < height)) return 0;
      const float v = planes[c][std::size_t(j) * std::size_t(width) + std::size_t(i)];
      return std::isfinite(v) && v > 0 ? v : 0;
    };
    return std::lerp(std::lerp(sample(fx, fy), sample(fx + 1, fy), x - fx),
                     std::lerp(sample(fx, fy + 1), sample(fx + 1, fy + 1), x - fx),
                     y - fy);
  }
};

Picture read_picture(const std::string& path) try {
  Imf::InputFile file(path.c_str(), 1);
  const Imath::Box2i window = file.header().dataWindow();
  Picture p;
  p.width = window.max.x - window.min.x + 1;
  p.height = window.max.y - window.min.y + 1;
  if (std::int64_t(p.width) * p.height > std::int64_t{1} << 26)
    throw std::runtime_error("larger than 64 million pixels");
  const bool grey = !file.header().channels().findChannel("R") &&
                    file.header().channels().findChannel("Y");
  Imf::FrameBuffer buffer;
  const char* const names[3] = {"R", "G", "B"};
  for (std::size_t c = 0; c < 3; ++c) {
    if (!grey && !file.header().channels().findChannel(names[c]))
      throw std::runtime_error(std::string("no channel ") + names[c]);
    p.planes[c].resize(std::size_t(p.width) * std::size_t(p.height));
    if (grey && c > 0) continue;
    const std::ptrdiff_t start = std::ptrdiff_t(window.min.y) * p.width + window.min.x;
    buffer.insert(
        grey ? "Y" : names[c],
        Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(p.planes[c].data() - start),
                   sizeof(float), sizeof(float) * std::size_t(p.width)));
  }
  file.setFrameBuffer(buffer);
  file.readPixels(window.min.y, window.max.y);
  if (grey) p.planes[1] = p.planes[2] = p.planes[0];
  return p;
} catch (const std::exception& e) {
  throw std::runtime_error("image = \"" + path + "\": " + e.what());
}

}  // namespace

Kernel image_kernel(const PatternSettings& s, int width, int height) {
  const Picture picture = read_picture(s.image);
  const double scale = picture.width * s.pixel / s.image_width;  // its pixels per ours
  const double corner = std::hypot(picture.width, picture.height) / 2 / scale;
  const int reach = int(std::ceil(corner)) + 1;
  if (reach > kMostReach)
    throw std::runtime_error("image_width: the pattern reaches " + std::to_string(reach) +
                             " pixels far, allowed " + std::to_string(kMostReach));
  Kernel k;
  k.reach_x = std::min(reach, width - 1);
  k.reach_y = std::min(reach, height - 1);
  const std::size_t wide = std::size_t(k.width());
  k.planes.assign(3, std::vector<float>(wide * std::size_t(2 * k.reach_y + 1)));
  const int n = std::clamp(int(std::ceil(scale)), 1, 16);  // samples per side of a pixel
  const double cosine = std::cos(s.rotation), sine = std::sin(s.rotation);
  const double mx = (picture.width - 1) / 2., my = (picture.height - 1) / 2.;
  std::vector<std::array<double, 3>> outside(std::size_t(2 * reach) + 1);
  tbb::parallel_for(-reach, reach + 1, [&](int y) {
    for (int x = -reach; x <= reach; ++x) {
      double sum[3] = {};
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          const double u = (x + (i + 0.5) / n - 0.5) * scale,
                       v = (y + (j + 0.5) / n - 0.5) * scale;
          for (std::size_t c = 0; c < 3; ++c)
            sum[c] +=
                picture.at(c, mx + cosine * u + sine * v, my + cosine * v - sine * u);
        }
      for (std::size_t c = 0; c < 3; ++c) {
        if (std::abs(x) <= k.reach_x && std::abs(y) <= k.reach_y)
          k.planes[c][std::size_t(y + k.reach_y) * wide + std::size_t(x + k.reach_x)] =
              float(sum[c]);
        else
          outside[std::size_t(y + reach)][c] += sum[c];
      }
    }
  });
  for (const auto& row : outside)
    for (std::size_t c = 0; c < 3; ++c) k.beyond[c] += row[c];
  return k;
}

Kernel make_kernel(const PatternSettings& s, int width, int height) {
  Kernel k = s.kind == "aperture" ? aperture_kernel(s, width, height)
             : s.kind == "image"  ? image_kernel(s, width, height)
                                  : eye_kernel(s, width, height);
  for (std::size_t c = 0; c < k.planes.size(); ++c) {
    std::vector<float>& plane = k.planes[c];
    float& centre = k.quadrant ? plane[0] : plane[plane.size() / 2];
    const auto others = [&] {
      double sum = 0;
      const std::size_t wide = std::size_t(k.width());
      for (std::size_t i = 0; i < plane.size(); ++i)
        if (&plane[i] != &centre)
          sum +=
              (k.quadrant ? (i % wide ? 2. : 1.) * (i / wide ? 2. : 1.) : 1.) * plane[i];
      return sum;
    };
    const double sum = others() + centre + k.beyond[c];
    if (!(sum > 0)) throw std::runtime_error("the pattern is black");
    for (float& v : plane) v = float(v / sum);
    k.beyond[c] /= sum;
    // The rounded weights are what counts; the centre makes good what they are off.
    k.lost[c] = std::min(1., others() + k.beyond[c]);
    centre = float(1 - k.lost[c]);
  }
  if (k.planes.size() == 1) {
    k.beyond[1] = k.beyond[2] = k.beyond[0];
    k.lost[1] = k.lost[2] = k.lost[0];
  }
  return k;
}

std::string PatternSettings::key() const {
  std::ostringstream t;
  t.precision(17);
  t << kind << ' ' << pixel;
  if (kind == "aperture") {
    t << ' ' << rotation << ' ' << aperture << ' ' << blades << ' ' << roundness << ' '
      << dust << ' ' << scratches << ' ' << seed;
  } else if (kind == "image") {
    std::error_code none;
    t << ' ' << rotation << ' ' << image_width << ' ' << image << ' '
      << std::filesystem::last_write_time(image, none).time_since_epoch().count();
  } else {
    t << ' ' << reach;
  }
  if (kind != "photopic")
    for (const double c : chromaticities) t << ' ' << c;
  return t.str();
}

}  // namespace brume::glare
