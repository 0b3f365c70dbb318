// Small frames for the transcripts, and sums of pixels to compare them.
//
//   frame_tool make OUT [width=8] [height=8] [x=0] [y=0] [depth=ramp|none|NUMBER]
//                       [camera=1] [alpha=1] [compression=zip] [value=NUMBER]
//   frame_tool sum FILE [x,y,width,height]     one line per channel: name, 64-bit sum
//   frame_tool at FILE x,y                     one line per channel: name, value

#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <string>

#include "image/io.h"
#include "num/error.h"

namespace {
using namespace brume;

// A camera at (0, 0, 2) that looks along +y, up +z, 90 degrees wide.
void add_camera(ImageHeader& h) {
  const double aspect = double(h.display_window.width) / h.display_window.height;
  const double near = 0.1, far = 1e4;
  const double camera[4][4] = {{1, 0, 0, 0}, {0, 0, 1, 0}, {0, 1, 0, 0}, {0, -2, 0, 1}};
  const double ndc[4][4] = {{0.5, 0, 0, 0},
                            {0, -0.5 * aspect, 0, 0},
                            {0.5, 0.5, far / (far - near), 1},
                            {0, 0, -near * far / (far - near), 0}};
  float world_to_camera[16], world_to_ndc[16];
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      double sum = 0;
      for (int k = 0; k < 4; ++k) sum += camera[i][k] * ndc[k][j];
      world_to_camera[4 * i + j] = float(camera[i][j]);
      world_to_ndc[4 * i + j] = float(sum);
    }
  h.attributes["worldToCamera"] = Attribute::from_floats("m44f", world_to_camera);
  h.attributes["worldToNDC"] = Attribute::from_floats("m44f", world_to_ndc);
}

// The upper quarter is sky: alpha 0, depth 1e10. Below, depth falls from 1000 to 10.
void make(const std::string& file, std::map<std::string, std::string> say) {
  const auto number = [&](const char* key, double otherwise) {
    return say.contains(key) ? std::stod(say[key]) : otherwise;
  };
  Image image;
  ImageHeader& h = image.header;
  const int width = int(number("width", 8)), height = int(number("height", 8));
  h.display_window = {0, 0, width, height};
  h.data_window = {int(number("x", 0)), int(number("y", 0)), width, height};
  if (say.contains("compression"))
    h.compression = compression_from(say["compression"]).value();
  const std::string depth = say.contains("depth") ? say["depth"] : "ramp";
  const bool alpha = number("alpha", 1) != 0;
  for (const char* name : {"A", "B", "G", "R", "Z"}) {
    if ((*name == 'Z' && depth == "none") || (*name == 'A' && !alpha)) continue;
    h.channels.push_back(
        {.name = name, .type = *name == 'Z' ? PixelType::float32 : PixelType::half});
  }
  if (number("camera", 1) != 0) add_camera(h);
  for (const Channel& c : h.channels) {
    auto& plane = image.planes.emplace_back(std::size_t(width) * std::size_t(height));
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const bool sky = 4 * y < height;
        const double down = double(y) / height, right = double(x) / width;
        double v = c.name == "Z"   ? (sky ? 1e10 : 1000 * std::pow(10, -2 * down))
                   : c.name == "A" ? !sky
                   : sky           ? 0
                   : c.name == "R" ? 0.5 * right
                   : c.name == "G" ? 0.5 * down
                                   : 0.25;
        if (c.name == "Z" && depth != "ramp") v = std::stod(depth);
        if (say.contains("value") && c.name != "Z" && c.name != "A" && !sky)
          v = std::stod(say["value"]);
        plane[std::size_t(y) * std::size_t(width) + std::size_t(x)] = float(v);
      }
  }
  write_image(image, file);
}

// FNV-1a over the bits of the values in the window.
void sum(const std::string& file, const char* window) {
  const Image image = read_image(file);
  const Window all = image.header.data_window;
  Window w = all;
  if (window) std::sscanf(window, "%d,%d,%d,%d", &w.x, &w.y, &w.width, &w.height);
  for (std::size_t k = 0; k < image.planes.size(); ++k) {
    std::uint64_t hash = 14695981039346656037u;
    for (int y = w.y; y < w.bottom(); ++y)
      for (int x = w.x; x < w.right(); ++x) {
        std::uint32_t bits;
        std::memcpy(&bits,
                    &image.planes[k][std::size_t(y - all.y) * all.width + x - all.x],
                    sizeof bits);
        hash = (hash ^ bits) * 1099511628211u;
      }
    std::printf("%s %016" PRIx64 "\n", image.header.channels[k].name.c_str(), hash);
  }
}

void at(const std::string& file, const char* pixel) {
  const Image image = read_image(file);
  const Window w = image.header.data_window;
  int x = 0, y = 0;
  std::sscanf(pixel, "%d,%d", &x, &y);
  for (std::size_t k = 0; k < image.planes.size(); ++k)
    std::printf("%s %.6g\n", image.header.channels[k].name.c_str(),
                double(image.planes[k][std::size_t(y - w.y) * w.width + x - w.x]));
}

}  // namespace

int main(int argc, char** argv) try {
  const std::string what = argc > 2 ? argv[1] : "";
  if (what == "make") {
    std::map<std::string, std::string> say;
    for (int i = 3; i < argc; ++i) {
      const std::string word = argv[i];
      const auto equals = word.find('=');
      say[word.substr(0, equals)] = word.substr(equals + 1);
    }
    make(argv[2], say);
    return 0;
  }
  if (what == "sum") {
    sum(argv[2], argc > 3 ? argv[3] : nullptr);
    return 0;
  }
  if (what == "at" && argc > 3) {
    at(argv[2], argv[3]);
    return 0;
  }
  std::fputs(
      "usage: frame_tool make OUT [key=value...] | sum FILE [x,y,w,h] | at FILE x,y\n",
      stderr);
  return 2;
} catch (const std::exception& e) {
  std::fprintf(stderr, "frame_tool: %s\n", e.what());
  return 1;
}
