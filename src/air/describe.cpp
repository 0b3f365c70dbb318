#include <algorithm>

#include "air/impl.h"

namespace brume {
namespace {

std::string form_of_glow(const Air::Impl& air) {
  const auto all = air.lamps.size();
  const auto closed = std::size_t(std::count_if(air.lamps.begin(), air.lamps.end(),
                                                [](const auto& l) { return l.closed; }));
  if (closed == 0) return "lamps by angle";
  if (closed == all) return "lamps in closed form";
  return std::to_string(closed) + " of " + std::to_string(all) +
         " lamps in closed form, the others by angle";
}

}  // namespace

std::vector<std::string> Air::describe() const {
  std::vector<std::string> lines;
  std::vector<std::pair<std::string, int>> alike;  // in a row
  const auto& air = *impl_;
  const std::string glow = form_of_glow(air);
  for (std::size_t i = 0; i < air.media.size(); ++i) {
    const air::Medium& m = air.media[i];
    static const char* const profiles[] = {"uniform", "exponential", "lorentzian",
                                           "own profile"};
    std::string line = air.media_names[i] + ": " + profiles[m.profile];
    if (!m.absorbs) line += ", emission only";
    const bool dark = m.S[0] == 0 && m.S[1] == 0 && m.S[2] == 0;
    if (m.source_at)
      line += ", own source";
    else if (m.absorbs && m.glows_by_sun)
      line += m.closed ? ", sun and sky (constant)" : ", sun and sky (dimmed on the way)";
    else if (m.absorbs)
      line += dark ? ", absorption only" : ", constant source";
    line += m.alone    ? ": its own form"
            : m.closed ? ": closed form"
                       : ": steps in optical depth";
    if (m.glows_by_lamp) line += "; " + glow;
    if (!alike.empty() && alike.back().first == line)
      ++alike.back().second;
    else
      alike.emplace_back(line, 1);
  }
  for (const auto& [line, count] : alike)
    lines.push_back(count > 1 ? line + " (" + std::to_string(count) + " media)" : line);
  if (air.media.size() > 1)
    lines.push_back("where they overlap: parabola in optical depth, until the tolerance");
  return lines;
}

}  // namespace brume
