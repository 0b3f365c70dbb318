#include "pipeline/inputs.h"

#include <algorithm>

#include "num/error.h"
#include "params/params.h"

namespace brume {
namespace {

std::string list_of(const ImageHeader& h) {
  std::string s;
  for (const Channel& c : h.channels) s += (s.empty() ? "" : ", ") + c.name;
  return s.empty() ? "no channels" : s;
}

[[noreturn]] void no_channel(const ImageHeader& h, const std::string& where,
                             const std::string& what, const std::string& wanted) {
  std::vector<std::string> names;
  for (const Channel& c : h.channels) names.push_back(c.name);
  const std::string near = nearest_name(wanted, names);
  throw Error(where, what,
              near.empty() ? "it has " + list_of(h) : "did you mean " + near + "?");
}

bool ends_with(const std::string& s, const std::string& tail) {
  return s.size() >= tail.size() &&
         s.compare(s.size() - tail.size(), tail.size(), tail) == 0;
}

std::string lower(std::string s) {
  std::transform(s.begin(), s.end(), s.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return s;
}

}  // namespace

ChannelName parse_channel(const std::string& text) {
  const auto colon = text.rfind(':');
  if (colon != std::string::npos &&
      text.find_first_of("./\\") <
          colon)  // a file name has a dot or a slash before the colon
    return {text.substr(0, colon), text.substr(colon + 1)};
  return {"", text};
}

const ImageHeader& InputList::header(const std::string& file) const {
  if (file.empty()) return source_.header;
  const ImageHeader* h = source_.other_header ? source_.other_header(file) : nullptr;
  if (!h) throw Error(file, "the scene reads this file, but it was not given", "");
  return *h;
}

int InputList::add(const std::string& file, const std::string& channel,
                   const std::string& purpose) {
  const ImageHeader& h = header(file);
  if (h.find(channel) < 0)
    no_channel(h, where(file), "no channel " + channel + " for " + purpose, channel);
  if (!file.empty()) {
    const Window &a = h.display_window, &b = source_.header.display_window;
    if (a.width != b.width || a.height != b.height)
      throw Error(file,
                  purpose + " is " + std::to_string(a.width) + "x" +
                      std::to_string(a.height) + " pixels",
                  source_.name + " is " + std::to_string(b.width) + "x" +
                      std::to_string(b.height));
  }
  for (std::size_t i = 0; i < inputs_.size(); ++i)
    if (inputs_[i].file == file && inputs_[i].channel == channel) {
      inputs_[i].purpose += ", " + purpose;
      return int(i);
    }
  inputs_.push_back({file, channel, purpose});
  return int(inputs_.size()) - 1;
}

int InputList::add(const std::string& text, const std::string& purpose) {
  const ChannelName n = parse_channel(text);
  return add(n.file, n.channel, purpose);
}

int InputList::add_if_present(const std::string& text, const std::string& purpose) {
  const ChannelName n = parse_channel(text);
  return header(n.file).find(n.channel) < 0 ? -1 : add(n.file, n.channel, purpose);
}

ColorNames find_color(const ImageHeader& h, const std::string& layer,
                      const std::string& where) {
  const auto of_layer = [&](const std::string& prefix, ColorNames& out) {
    for (const char* rgba : {"RGBA", "rgba"}) {
      bool all = true;
      for (int c = 0; c < 3; ++c) all = all && h.find(prefix + rgba[c]) >= 0;
      if (!all) continue;
      for (int c = 0; c < 3; ++c) out.rgb[c] = prefix + rgba[c];
      out.alpha = h.find(prefix + rgba[3]) >= 0 ? prefix + rgba[3] : "";
      return true;
    }
    return false;
  };
  ColorNames out;
  if (!layer.empty()) {
    if (of_layer(layer + ".", out))
      return out.why = "layer " + layer + " of the scene file", out;
    no_channel(h, where, "no colour layer " + layer + " (" + layer + ".R, .G, .B)",
               layer + ".R");
  }
  if (of_layer("", out)) return out.why = "named R, G, B", out;

  // Layers, the usual names of the beauty first; the only one there is serves too.
  std::vector<std::string> layers;
  for (const Channel& c : h.channels)
    if (ends_with(c.name, ".R") || ends_with(c.name, ".r"))
      layers.push_back(c.name.substr(0, c.name.size() - 1));
  for (const char* usual : {"combined.", "rgba.", "beauty.", "finalimage."})
    for (const std::string& prefix : layers)
      if (ends_with(lower(prefix), usual) && of_layer(prefix, out))
        return out.why = "layer " + prefix.substr(0, prefix.size() - 1), out;
  if (layers.size() == 1 && of_layer(layers[0], out))
    return out.why = "the only colour layer there is", out;
  throw Error(where, "no colour: no R, G, B, and no layer that is clearly the picture",
              "it has " + list_of(h) + "; name one with [input] color = \"LAYER\"");
}

std::vector<std::string> find_vector(const ImageHeader& h, const std::string& layer,
                                     const std::string& where) {
  for (const char* xyz : {"XYZ", "xyz", "RGB", "rgb"}) {
    std::vector<std::string> names;
    for (int c = 0; c < 3; ++c) {
      const std::string name = layer + "." + xyz[c];
      if (h.find(name) >= 0) names.push_back(name);
    }
    if (names.size() == 3) return names;
  }
  no_channel(h, where, "no layer " + layer + " with components X, Y, Z", layer + ".X");
}

}  // namespace brume
