#include "params/document.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "params/text.h"

namespace brume {
namespace {

std::string default_text(const ParamSpec& s) {
  Value v = default_value(s);
  // Three equal numbers are said once, as people write them.
  if (s.kind == Kind::rgb && v.numbers.size() == 3 && v.numbers[0] == v.numbers[1] &&
      v.numbers[1] == v.numbers[2])
    return detail::number_text(v.numbers[0]);
  if (s.kind == Kind::number) return detail::number_text(v.numbers[0]);
  if (s.kind == Kind::vec3 || s.kind == Kind::rgb) {
    if (v.numbers.empty()) return print(s, v);
    std::string out;
    for (const double x : v.numbers)
      out += (out.empty() ? "" : ", ") + detail::number_text(x);
    return "[" + out + "]";
  }
  return print(s, v);
}

std::string allowed_text(const ParamSpec& s) {
  std::vector<std::string> words;
  for (const std::string& w : s.words) words.push_back(detail::quoted(w));
  const std::string list = detail::joined(words);
  std::string range = range_text(s);
  if (range.empty() && !s.unit.empty()) range = s.unit;
  switch (s.kind) {
    case Kind::flag:
      return "true, false";
    case Kind::choice:
      return list;
    case Kind::text:
      return "text";
    case Kind::texts:
      return "list of texts";
    case Kind::rgb:
      return "number or [r, g, b]" + (range.empty() ? "" : ", " + range) +
             (list.empty() ? "" : "; or " + list);
    case Kind::vec3:
      return "[x, y, z]" + (range.empty() ? "" : ", " + range);
    case Kind::numbers:
      return "list of numbers" + (range.empty() ? "" : ", " + range);
    case Kind::matrix:
      return "16 numbers, row by row";
    case Kind::integer:
      return "whole number" + (range.empty() ? "" : ", " + range);
    case Kind::number:
      break;
  }
  return range.empty() ? "number" : range;
}

std::string doc_text(const ParamSpec& s) {
  if (!s.knob) return s.doc;
  return s.doc + (s.doc.empty() ? "" : " ") + "Set from `tolerance` unless given.";
}

std::string cell(std::string s) {
  for (std::size_t i = 0; (i = s.find('|', i)) != std::string::npos; i += 2)
    s.insert(i, "\\");
  return s;
}

// Text broken at spaces into lines of at most `width` characters (a longer word stands).
std::vector<std::string> wrapped(std::string_view text, std::size_t width) {
  std::vector<std::string> lines{""};
  while (!text.empty()) {
    const std::size_t n = std::min(text.find(' '), text.size());
    const std::string_view word = text.substr(0, n);
    if (!lines.back().empty() && lines.back().size() + 1 + n > width)
      lines.emplace_back();
    lines.back() += (lines.back().empty() ? "" : " ") + std::string(word);
    text.remove_prefix(std::min(n + 1, text.size()));
  }
  return lines;
}

}  // namespace

std::string markdown_table(std::span<const ParamSpec> specs) {
  std::string out = "| parameter | default | allowed | what it is |\n|---|---|---|---|\n";
  for (const ParamSpec& s : specs)
    out += "| `" + s.name + "` | `" + cell(default_text(s)) + "` | " +
           cell(allowed_text(s)) + " | " + cell(doc_text(s)) + " |\n";
  return out;
}

std::string text_table(std::span<const ParamSpec> specs, int width) {
  using Row = std::array<std::string, 4>;
  std::vector<Row> rows;
  std::array<std::size_t, 3> widths{};
  for (const ParamSpec& s : specs) {
    rows.push_back({s.name, default_text(s), allowed_text(s), doc_text(s)});
    for (std::size_t c = 0; c < 3; ++c)
      widths[c] = std::max(widths[c], std::min<std::size_t>(rows.back()[c].size(), 28));
  }
  const std::size_t before = widths[0] + widths[1] + widths[2] + 6;
  const std::size_t room =
      std::max<std::size_t>(24, width > int(before) ? width - before : 0);
  const std::array<std::size_t, 4> room_of{widths[0], widths[1], widths[2], room};
  std::string out;
  for (const Row& row : rows) {
    std::array<std::vector<std::string>, 4> lines;
    std::size_t height = 0;
    for (std::size_t c = 0; c < 4; ++c) {
      lines[c] = wrapped(row[c], room_of[c]);
      height = std::max(height, lines[c].size());
    }
    for (std::size_t y = 0; y < height; ++y) {
      std::string line;
      for (std::size_t c = 0; c < 4; ++c) {
        const std::string& part = y < lines[c].size() ? lines[c][y] : std::string();
        line += part;
        if (c < 3) line.append(room_of[c] + 2 - std::min(part.size(), room_of[c]), ' ');
      }
      out += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
    }
  }
  return out;
}

std::string replace_generated(std::string_view file, std::string_view name,
                              std::string_view text) {
  const std::string begin = "<!-- generated: " + std::string(name) + " -->";
  constexpr std::string_view end = "<!-- end -->";
  std::string out;
  std::size_t from = 0;
  for (std::size_t at; (at = file.find(begin, from)) != std::string_view::npos;) {
    const std::size_t body = at + begin.size();
    const std::size_t stop = file.find(end, body);
    if (stop == std::string_view::npos)
      throw Error(begin, "has no " + std::string(end), "");
    out += file.substr(from, body - from);
    out += "\n";
    out += text;
    if (!text.empty() && text.back() != '\n') out += "\n";
    from = stop;
  }
  if (from == 0)
    throw Error(begin, "not found", "put it and " + std::string(end) + " in the file");
  return out + std::string(file.substr(from));
}

}  // namespace brume
