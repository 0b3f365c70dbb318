// brume view: a picture to look at.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "commands.h"
#include "image/io.h"
#include "num/error.h"
#include "params/params.h"
#include "picture/picture.h"
#include "scene/view.h"

namespace brume::cli {
namespace fs = std::filesystem;

namespace {

// "file:layer"; the colon of a file that exists under the whole name is its own.
struct Source {
  std::string file, layer;
};
Source source_from(const std::string& text, const std::string& layer) {
  std::error_code none;
  const auto colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0 || fs::exists(text, none))
    return {text, layer};
  return {text.substr(0, colon), text.substr(colon + 1)};
}

// What is drawn: three channels as colour or as directions, or one.
struct Layer {
  enum class Is { color, vector, depth, single } is;
  std::vector<std::string> channels;
};

Layer find_layer(const ImageHeader& h, const Source& source) {
  const auto has = [&](const std::string& name) { return h.find(name) >= 0; };
  const std::string prefix = source.layer.empty() ? "" : source.layer + ".";
  if (!source.layer.empty() && has(source.layer)) {
    const DepthChoice depth = find_depth(h);
    const auto dot = source.layer.rfind('.');
    const std::string last =
        dot == std::string::npos ? source.layer : source.layer.substr(dot + 1);
    const bool is_depth = (depth.channel >= 0 &&
                           h.channels[std::size_t(depth.channel)].name == source.layer) ||
                          last == "Z" || last == "z";
    return {is_depth ? Layer::Is::depth : Layer::Is::single, {source.layer}};
  }
  for (const char* names : {"RGB", "rgb", "XYZ", "xyz"}) {
    const std::array<std::string, 3> three = {prefix + names[0], prefix + names[1],
                                              prefix + names[2]};
    if (!std::all_of(three.begin(), three.end(), has)) continue;
    const bool vector = names[0] == 'X' || names[0] == 'x';
    return {vector ? Layer::Is::vector : Layer::Is::color, {three.begin(), three.end()}};
  }
  for (const char* name : {"Y", "Z", "V", "A"})
    if (has(prefix + name)) {
      const bool depth = *name == 'Z' || source.layer.ends_with("Depth") ||
                         source.layer.ends_with("depth");
      return {depth ? Layer::Is::depth : Layer::Is::single, {prefix + name}};
    }
  std::vector<std::string> known;
  for (const Channel& c : h.channels) {
    known.push_back(c.name);
    if (const auto dot = c.name.rfind('.'); dot != std::string::npos)
      if (known.empty() || known.back() != c.name.substr(0, dot))
        known.push_back(c.name.substr(0, dot));
  }
  const std::string near = nearest_name(source.layer, known);
  std::string all;
  for (const Channel& c : h.channels) all += (all.empty() ? "" : ", ") + c.name;
  throw Error(source.file,
              source.layer.empty() ? "no colour to draw" : "no layer " + source.layer,
              near.empty() ? "it has " + all : "did you mean " + near + "?");
}

// Light is shown as it is: a transmittance has no highlights to roll off.
bool is_transmittance(const std::string& layer) {
  return layer == "T" || layer.ends_with(".T");
}

// A picture made for the screen: it has been through a curve and sRGB already.
bool is_for_screen(const fs::path& file) {
  const std::string e = file.extension().string();
  return e == ".png" || e == ".jpg" || e == ".jpeg" || e == ".webp" || e == ".bmp";
}

Range range_from(const std::string& text) {
  Range r;
  int end = 0;
  if (std::sscanf(text.c_str(), "%lf,%lf%n", &r.low, &r.high, &end) != 2 ||
      text[std::size_t(end)] != 0 || !std::isfinite(r.low) || !std::isfinite(r.high) ||
      r.low >= r.high)
    throw UsageError("view: --range " + text + ": write A,B with A below B");
  r.logarithmic = r.low > 0 && r.high / r.low > 20;
  return r;
}

std::array<float, 3> color_from(const std::string& text) {
  std::array<float, 3> c{};
  int end = 0;
  if (std::sscanf(text.c_str(), "%f,%f,%f%n", &c[0], &c[1], &c[2], &end) != 3 ||
      text[std::size_t(end)] != 0)
    throw UsageError("view: --background " + text + ": write R,G,B");
  return c;
}

class Drawer {
 public:
  explicit Drawer(const ViewArguments& a) : a_(a) {
    gain_ = float(std::exp2(a.exposure));
    if (!a.range.empty()) range_ = range_from(a.range);
    if (!a.background.empty()) background_ = color_from(a.background);
  }

  Tile draw(const Source& source) const {
    const ImageHeader header = read_headers(source.file).front();
    const Layer layer = find_layer(header, source);
    if (layer.is == Layer::Is::depth ||
        (layer.is == Layer::Is::single && !a_.range.empty()))
      return in_false_color(source, layer);
    // The background stands behind the picture itself, whose coverage is A.
    const bool open = background_ && layer.is == Layer::Is::color &&
                      source.layer.empty() && header.find("A") >= 0;
    return in_color(source, layer, open);
  }

 private:
  Tile in_false_color(const Source& source, const Layer& layer) const {
    const Image image = read_image(source.file, 0, layer.channels);
    const std::span<const float> values = image.plane(0);
    Tile tile;
    tile.has_range = true;
    tile.range = a_.range.empty() ? range_of(values) : range_;
    tile.picture = on_display(image.header, [&](std::size_t i, float* rgb) {
      const float t = place(tile.range, values[i]);
      const auto color = std::isnan(t) ? std::array<float, 3>{} : false_color(t);
      std::copy(color.begin(), color.end(), rgb);
    });
    return tile;
  }

  Tile in_color(const Source& source, const Layer& layer, bool open) const {
    std::vector<std::string> wanted = layer.channels;
    if (open) wanted.push_back("A");
    const Image image = read_image(source.file, 0, wanted);
    std::span<const float> alpha;
    if (open) alpha = image.plane(image.header.find("A"));
    std::array<std::span<const float>, 3> planes;
    for (std::size_t c = 0; c < 3; ++c)
      planes[c] = image.plane(
          image.header.find(layer.channels[std::min(c, layer.channels.size() - 1)]));

    const bool screen = layer.is == Layer::Is::color && is_for_screen(source.file);
    const bool vector = layer.is == Layer::Is::vector;
    const bool as_it_is = layer.is != Layer::Is::color || is_transmittance(source.layer);
    const Curve curve = a_.curve == "linear" || (a_.curve.empty() && as_it_is)
                            ? Curve::linear
                            : Curve::filmic;
    Tile tile;
    tile.picture = on_display(image.header, [&](std::size_t i, float* rgb) {
      for (std::size_t c = 0; c < 3; ++c) {
        float v = planes[c][i];
        if (open) v += (1 - alpha[i]) * (*background_)[c];
        if (vector) v = 0.5f + 0.5f * v;
        rgb[c] = screen ? srgb_decoded(v) : tone(gain_ * v, curve);
      }
    });
    return tile;
  }

  // Fills the display window from the data window; beyond the data it is black.
  template <class Pixel>
  Picture on_display(const ImageHeader& header, const Pixel& pixel) const {
    const Window d = header.display_window, w = header.data_window,
                 both = intersect(d, w);
    Picture out(d.width, d.height);
    for (int y = both.y; y < both.bottom(); ++y)
      for (int x = both.x; x < both.right(); ++x)
        pixel(std::size_t(y - w.y) * std::size_t(w.width) + std::size_t(x - w.x),
              out.pixel(x - d.x, y - d.y));
    return out;
  }

  const ViewArguments& a_;
  float gain_ = 1;
  Range range_;
  std::optional<std::array<float, 3>> background_;
};

std::string label_of(const Source& s) {
  const std::string name = fs::path(s.file).filename().string();
  return s.layer.empty() ? name : name + "  " + s.layer;
}

}  // namespace

int view(const ViewArguments& a, const Terminal& terminal) {
  std::error_code none;
  if (fs::is_directory(a.out, none)) throw Error(a.out, "is a directory");
  if (!a.overwrite && fs::exists(a.out, none))
    throw Error(a.out, "exists", "--overwrite replaces it");
  const Drawer drawer(a);
  std::vector<Tile> tiles;
  for (std::size_t i = 0; i < a.in.size(); ++i) {
    const Source source = source_from(a.in[i], a.layer);
    tiles.push_back(drawer.draw(source));
    if (i < a.labels.size())
      tiles.back().label = a.labels[i];
    else if (a.in.size() > 1)
      tiles.back().label = label_of(source);
  }
  const Picture sheet = montage(tiles, {.columns = a.columns, .width = a.width});
  write_image(screen_image(sheet), a.out);
  terminal.detail(fmt::format("{}  {} x {}", a.out, sheet.width, sheet.height));
  return kOk;
}

}  // namespace brume::cli
