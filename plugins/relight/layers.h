#pragma once
// Layers of a frame by the names that renderers give them.

#include <initializer_list>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace relight {

using Names = std::vector<std::string>;  ///< three channels

namespace detail {

inline bool has(std::span<const char* const> channels, const std::string& name) {
  for (const char* c : channels)
    if (name == c) return true;
  return false;
}

inline std::optional<Names> components(std::span<const char* const> channels,
                                       const std::string& layer,
                                       std::initializer_list<const char*> kinds) {
  for (const char* kind : kinds) {
    Names names;
    for (int c = 0; c < 3; ++c) {
      names.push_back(layer + "." + kind[c]);
      if (!has(channels, names.back())) names.pop_back();
    }
    if (names.size() == 3) return names;
  }
  return {};
}

}  // namespace detail

/// The layer of the frame that is called `setting`, in components of one of `kinds`
/// ("XYZ"). "auto": the first of `usual` that there is, alone or as the end of a longer
/// name ("ViewLayer.Normal"), or none. "none": none. A layer of another file
/// ("normals.####.exr:N") is taken to have those of the first kind. Throws
/// std::runtime_error for one that is not there.
inline std::optional<Names> find_layer(std::span<const char* const> channels,
                                       const std::string& setting,
                                       std::initializer_list<const char*> usual,
                                       std::initializer_list<const char*> kinds) {
  if (setting == "none") return {};
  if (setting != "auto") {
    if (setting.find(':') != setting.npos) {
      Names names;
      for (int c = 0; c < 3; ++c) names.push_back(setting + "." + (*kinds.begin())[c]);
      return names;
    }
    if (auto found = detail::components(channels, setting, kinds)) return found;
    throw std::runtime_error("no layer " + setting + " with components " +
                             *kinds.begin() + " in the frame");
  }
  for (const char* name : usual)
    if (auto found = detail::components(channels, name, kinds)) return found;
  for (const char* name : usual) {
    const std::string end = std::string(".") + name + ".";
    for (const char* channel : channels) {
      const std::string c = channel;
      const std::size_t dot = c.rfind('.');
      if (dot == c.npos || dot + 1 < end.size() ||
          c.compare(dot + 1 - end.size(), end.size(), end) != 0)
        continue;
      if (auto found = detail::components(channels, c.substr(0, dot), kinds))
        return found;
    }
  }
  return {};
}

}  // namespace relight
