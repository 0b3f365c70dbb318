// brume info: what brume understands of a file.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "commands.h"
#include "depth_stats.h"
#include "image/io.h"
#include "json.h"
#include "num/error.h"
#include "params/text.h"
#include "scene/frames.h"
#include "scene/view.h"
#include "table.h"

namespace brume::cli {

namespace {

const char* type_name(PixelType t) {
  return t == PixelType::half ? "half" : t == PixelType::float32 ? "float" : "uint";
}

std::string window_text(const Window& w) {
  return fmt::format("{} x {} at ({}, {})", w.width, w.height, w.x, w.y);
}

// An attribute's value for a person, on one line.
std::string value_text(const Attribute& a) {
  if (const auto text = a.text()) return detail::quoted(*text);
  if (const auto number = a.number()) return fmt::format("{:.7g}", *number);
  if (const auto numbers = a.numbers()) {
    std::string out;
    for (const double v : *numbers)
      out += fmt::format("{}{:.7g}", out.empty() ? "" : " ", v);
    return out;
  }
  return fmt::format("{} bytes", a.bytes.size());
}

// What the file alone says of its camera; `problem` where it is there but broken.
struct Camera {
  std::optional<View> view;
  std::string problem;
};
Camera camera_of(const ImageHeader& header, const std::string& file) {
  const SceneFile empty = parse_scene("version = 1", "", {});
  try {
    return {find_view(header, empty, frame_in_name(file).value_or(0), file), ""};
  } catch (const Error& e) {
    return {std::nullopt, e.what_found};
  }
}

const char* projection_name(Projection p) {
  return p == Projection::perspective    ? "perspective"
         : p == Projection::orthographic ? "orthographic"
                                         : "latlong";
}

// Horizontal angle of view in degrees.
double angle_of_view(const View& v) {
  const double middle = v.display.y + v.display.height / 2.0;
  const auto a = v.ray(v.display.x, middle).direction;
  const auto b = v.ray(v.display.right(), middle).direction;
  return std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0)) * 180 / 3.14159265358979324;
}

std::string vector_text(const glm::dvec3& v) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x + 0.0, v.y + 0.0,
                     v.z + 0.0);  // no -0
}

void print_camera(const Camera& c) {
  if (!c.view) {
    fmt::print("camera: {}\n", c.problem.empty() ? "none; a scene's [camera] can give one"
                                                 : "broken: " + c.problem);
    return;
  }
  const View& v = *c.view;
  fmt::print("camera: {} from {}\n", projection_name(v.projection), v.source);
  fmt::print("  at {}, looking along {}, up {}", vector_text(v.eye),
             vector_text(v.forward), vector_text(v.up));
  if (v.projection == Projection::perspective)
    fmt::print(", {:.4g} degrees wide", angle_of_view(v));
  std::fputc('\n', stdout);
}

void print_depth(const DepthStats& s, const std::string& channel,
                 const std::string& why) {
  fmt::print("depth: {} ({})\n", channel, why);
  fmt::print("  {:.4g} to {:.6g}, median {:.4g}; background {:.3g} % of the pixels",
             s.nearest, s.farthest, s.median,
             100.0 * double(s.background) / double(std::max<std::uint64_t>(s.pixels, 1)));
  if (!s.background_values.empty()) {
    std::string values;
    for (const double v : s.background_values)
      values += fmt::format("{}{:g}", values.empty() ? "" : ", ", v);
    fmt::print(" (written as {})", values);
  }
  fmt::print("\n  {}\n", s.convention);
  if (s.nan > 0) fmt::print("  {} pixels are NaN: background\n", s.nan);
  if (s.negative > 0) fmt::print("  {} pixels are negative: background\n", s.negative);
}

void print_header(const ImageHeader& h) {
  fmt::print("  data {}, display {}", window_text(h.data_window),
             window_text(h.display_window));
  fmt::print(", {}{}{}", name(h.compression), h.tiled ? ", tiled" : "",
             h.deep ? ", deep" : "");
  if (h.pixel_aspect != 1) fmt::print(", pixel aspect {:g}", h.pixel_aspect);
  if (!h.view.empty()) fmt::print(", view {}", h.view);
  std::fputc('\n', stdout);

  // Channels by layer, as a compositor knows them.
  std::map<std::string, std::map<std::string, std::string>> layers;  // layer, type, names
  for (const Channel& c : h.channels) {
    const auto dot = c.name.rfind('.');
    const std::string layer = dot == std::string::npos ? "" : c.name.substr(0, dot);
    std::string& names = layers[layer][type_name(c.type)];
    names += (names.empty() ? "" : " ") +
             (dot == std::string::npos ? c.name : c.name.substr(dot + 1));
    if (c.x_sampling != 1 || c.y_sampling != 1)
      names += fmt::format(" (1 of {} x {})", c.x_sampling, c.y_sampling);
  }
  std::vector<std::vector<std::string>> rows;
  for (const auto& [layer, types] : layers)
    for (const auto& [type, names] : types)
      rows.push_back({layer.empty() ? "(base)" : layer, type, names});
  std::fputs(table(rows, 2).c_str(), stdout);
}

void print_attributes(const ImageHeader& h) {
  if (h.attributes.empty()) return;
  fmt::print("attributes\n");
  std::vector<std::vector<std::string>> rows;
  for (const auto& [key, a] : h.attributes) {
    std::string value = value_text(a);
    if (value.size() > 100) value = value.substr(0, 97) + "...";
    rows.push_back({key, a.type, value});
  }
  std::fputs(table(rows).c_str(), stdout);
}

void window_json(Json& json, const char* key, const Window& w) {
  json.key(key).values(std::vector<int>{w.x, w.y, w.width, w.height});
}

void vector_json(Json& json, const char* key, const glm::dvec3& v) {
  json.key(key).values(std::vector<double>{v.x, v.y, v.z});
}

void header_json(Json& json, const ImageHeader& h) {
  window_json(json, "data_window", h.data_window);
  window_json(json, "display_window", h.display_window);
  json.key("name").value(h.part_name).key("view").value(h.view);
  json.key("compression").value(name(h.compression)).key("tiled").value(h.tiled);
  json.key("deep").value(h.deep).key("pixel_aspect").value(double(h.pixel_aspect));
  json.key("channels").array();
  for (const Channel& c : h.channels) {
    json.object().key("name").value(c.name).key("type").value(type_name(c.type));
    json.key("sampling").values(std::vector<int>{c.x_sampling, c.y_sampling}).end();
  }
  json.end().key("attributes").object();
  for (const auto& [key, a] : h.attributes) {
    json.key(key);
    if (const auto text = a.text())
      json.value(*text);
    else if (const auto number = a.number())
      json.value(*number);
    else if (const auto numbers = a.numbers())
      json.values(*numbers);
    else
      json.value(fmt::format("{}, {} bytes", a.type, a.bytes.size()));
  }
  json.end();
}

void camera_json(Json& json, const Camera& c) {
  json.key("camera").object();
  if (c.view) {
    const View& v = *c.view;
    json.key("projection").value(projection_name(v.projection));
    json.key("source").value(v.source);
    vector_json(json, "position", v.eye);
    vector_json(json, "forward", v.forward);
    vector_json(json, "up", v.up);
    if (v.projection == Projection::perspective)
      json.key("angle_of_view").value(angle_of_view(v));
  } else {
    json.key("problem").value(c.problem.empty() ? "none" : c.problem);
  }
  json.end();
}

void depth_json(Json& json, const DepthStats& s, const std::string& channel,
                const std::string& why) {
  json.key("depth").object().key("channel").value(channel).key("why").value(why);
  json.key("nearest").value(s.nearest).key("median").value(s.median);
  json.key("farthest").value(s.farthest).key("pixels").value(double(s.pixels));
  json.key("background").value(double(s.background)).key("nan").value(double(s.nan));
  json.key("background_values").values(s.background_values);
  json.key("convention").value(s.convention).end();
}

// Everything about one part, read before anything is printed: a broken file leaves no
// half of an answer.
struct PartInfo {
  ImageHeader header;
  Camera camera;
  DepthChoice depth;
  std::optional<DepthStats> stats;

  std::string depth_channel() const {
    return depth.channel < 0 ? "" : header.channels[std::size_t(depth.channel)].name;
  }
};

std::vector<PartInfo> read_parts(const std::string& file) {
  std::vector<PartInfo> parts;
  for (ImageHeader& h : read_headers(file)) {
    PartInfo part{.header = std::move(h), .camera = {}, .depth = {}, .stats = {}};
    part.camera = camera_of(part.header, file);
    part.depth = find_depth(part.header);
    if (part.depth.channel >= 0 && !part.header.deep)
      part.stats = depth_stats(*open_image(file, int(parts.size())), part.depth.channel);
    parts.push_back(std::move(part));
  }
  return parts;
}

void print_file(const std::string& file, const std::vector<PartInfo>& parts) {
  fmt::print("{}\n", file);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const PartInfo& p = parts[i];
    if (parts.size() > 1)
      fmt::print("part {}{}\n", i,
                 p.header.part_name.empty() ? "" : ": " + p.header.part_name);
    print_header(p.header);
    if (p.stats)
      print_depth(*p.stats, p.depth_channel(), p.depth.why);
    else
      fmt::print("depth: {}\n", p.depth.channel < 0 ? p.depth.why : p.depth_channel());
    print_camera(p.camera);
    print_attributes(p.header);
  }
}

void write_json(Json& json, const std::string& file, const std::vector<PartInfo>& parts) {
  json.object().key("file").value(file).key("parts").array();
  for (const PartInfo& p : parts) {
    json.object();
    header_json(json, p.header);
    camera_json(json, p.camera);
    if (p.stats) depth_json(json, *p.stats, p.depth_channel(), p.depth.why);
    json.end();
  }
  json.end().end();
}

}  // namespace

int info(const InfoArguments& a, const Terminal& terminal) {
  Json json;
  if (a.json) json.array();
  std::size_t failed = 0;
  bool printed = false;
  for (std::size_t i = 0; i < a.in.size(); ++i) {
    try {
      const std::vector<PartInfo> parts = read_parts(a.in[i]);
      if (a.json) {
        write_json(json, a.in[i], parts);
      } else {
        if (printed) std::fputc('\n', stdout);
        print_file(a.in[i], parts);
        printed = true;
      }
    } catch (const Error& e) {
      if (a.in.size() == 1) throw;
      terminal.error(e.what());
      ++failed;
    }
  }
  if (a.json) std::fputs(json.end().text().c_str(), stdout);
  return failed == 0 ? kOk : failed == a.in.size() ? kFailed : kSomeFramesFailed;
}

}  // namespace brume::cli
