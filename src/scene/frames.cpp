#include "scene/frames.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <system_error>

namespace brume {
namespace {

namespace fs = std::filesystem;

bool digit(char c) { return c >= '0' && c <= '9'; }

// For messages: one line, whatever the user typed.
std::string shown(std::string_view s) {
  std::string out;
  for (const char c : s.substr(0, 60))
    out += static_cast<unsigned char>(c) < 0x20 || c == 0x7F ? '?' : c;
  return s.size() > 60 ? out + "..." : out;
}

// A parser of "-5--1x2": one number at a time from the front.
struct FrameText {
  std::string_view rest;
  const std::string& where;
  std::string_view whole;

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(where + " " + shown(whole), what, "write frames as 1-100x2,200");
  }

  bool take(char c) {
    if (rest.empty() || rest[0] != c) return false;
    rest.remove_prefix(1);
    return true;
  }

  int number() {
    int value = 0;
    const auto [end, error] =
        std::from_chars(rest.data(), rest.data() + rest.size(), value);
    if (error == std::errc::invalid_argument)
      fail(rest.empty() ? "ends where a number should be"
                        : "a number should be at \"" + shown(rest) + "\"");
    if (error != std::errc() || value > kLargestFrame || value < -kLargestFrame)
      fail("a number beyond " + std::to_string(kLargestFrame));
    rest.remove_prefix(std::size_t(end - rest.data()));
    return value;
  }
};

// The number `s` begins with in the one way that frame_text writes it is found by
// writing it again; here only its digits are read.
std::optional<int> read_frame(std::string_view s) {
  int value = 0;
  const auto [end, error] = std::from_chars(s.data(), s.data() + s.size(), value);
  if (error != std::errc() || end != s.data() + s.size() ||
      std::abs(value) > kLargestFrame)
    return {};
  return value;
}

struct FrameToken {
  std::size_t length = 0;  // in the text; 0: none here
  int width = 1;
};

// ####, %d or %04d at s[i].
FrameToken frame_token(std::string_view s, std::size_t i) {
  if (s[i] == '#') {
    const std::size_t end = std::min(s.find_first_not_of('#', i), s.size());
    return {end - i, int(std::min<std::size_t>(end - i, 10))};
  }
  if (s[i] != '%') return {};
  std::size_t k = i + 1;
  if (k < s.size() && s[k] == 'd') return {2, 1};
  if (k >= s.size() || s[k] != '0') return {};
  int width = 0;
  while (++k < s.size() && digit(s[k])) width = std::min(10 * width + (s[k] - '0'), 10);
  if (k >= s.size() || s[k] != 'd' || width == 0) return {};
  return {k + 1 - i, width};
}

}  // namespace

std::vector<int> parse_frames(std::string_view text, const std::string& where) {
  FrameText in{text, where, text};
  std::vector<int> frames;
  do {
    const int first = in.number();
    int last = first, step = 1;
    if (in.take('-')) {
      last = in.number();
      if (last < first)
        in.fail(std::to_string(first) + "-" + std::to_string(last) + " runs backwards");
      if (in.take('x') && (step = in.number()) <= 0) in.fail("a step must be at least 1");
    }
    const long long count = (static_cast<long long>(last) - first) / step + 1;
    if (count + static_cast<long long>(frames.size()) > kMostFrames)
      in.fail("more than " + std::to_string(kMostFrames) + " frames");
    for (long long k = 0; k < count; ++k) frames.push_back(int(first + k * step));
  } while (in.take(','));
  if (!in.rest.empty()) in.fail("\"" + shown(in.rest) + "\" is no frame");
  std::sort(frames.begin(), frames.end());
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  return frames;
}

std::string frames_text(std::span<const int> f) {
  std::string out;
  for (std::size_t i = 0; i < f.size();) {
    // The longest run of one step from here; two frames are said singly unless adjacent.
    std::size_t end = i + 1;
    const long long step = end < f.size() ? static_cast<long long>(f[end]) - f[i] : 1;
    while (end < f.size() && static_cast<long long>(f[end]) - f[end - 1] == step) ++end;
    if (end - i == 2 && step != 1) end = i + 1;
    out += (out.empty() ? "" : ",") + std::to_string(f[i]);
    if (end - i > 1) {
      out += "-" + std::to_string(f[end - 1]);
      if (step != 1) out += "x" + std::to_string(step);
    }
    i = end;
  }
  return out;
}

FramePattern::FramePattern(std::string_view path) : text_(path) {
  if (path.size() > 4096 || path.find('\0') != std::string_view::npos)
    throw Error(shown(path), "is no path");
  std::string plain;
  const auto close = [&] {
    if (!plain.empty()) pieces_.push_back({Piece::Is::text, std::move(plain)});
    plain.clear();
  };
  for (std::size_t i = 0; i < path.size();) {
    const FrameToken token = frame_token(path, i);
    if (token.length > 0) {
      if (token.width > 9)
        throw Error(shown(path), "a frame of more than 9 digits", "write ####");
      if (has_frame_ && token.width != width_)
        throw Error(shown(path), "frames of different widths", "write them alike");
      close();
      pieces_.push_back({Piece::Is::frame, {}});
      width_ = token.width;
      has_frame_ = true;
      i += token.length;
    } else if (path[i] == '%' && i + 1 < path.size() &&
               (path[i + 1] == 'V' || path[i + 1] == 'v')) {
      close();
      pieces_.push_back(
          {path[i + 1] == 'V' ? Piece::Is::view : Piece::Is::view_letter, {}});
      has_view_ = true;
      i += 2;
    } else
      plain += path[i++];
  }
  close();
}

std::string FramePattern::frame_text(int frame) const {
  std::string digits = std::to_string(std::abs(static_cast<long long>(frame)));
  const std::size_t wanted = std::size_t(frame < 0 ? width_ - 1 : width_);
  if (digits.size() < wanted) digits.insert(0, wanted - digits.size(), '0');
  return frame < 0 ? "-" + digits : digits;
}

std::string FramePattern::expanded(const std::string& frame,
                                   std::string_view view) const {
  if (has_view_ && (view.empty() || view == "." || view == ".." ||
                    view.find_first_of(std::string_view("/\\\0", 3)) != view.npos))
    throw Error(shown(text_), "%V needs a view, not \"" + shown(view) + "\"",
                "views are called left and right");
  std::string out;
  for (const Piece& p : pieces_) switch (p.is) {
      case Piece::Is::text:
        out += p.text;
        break;
      case Piece::Is::frame:
        out += frame;
        break;
      case Piece::Is::view:
        out += view;
        break;
      case Piece::Is::view_letter:
        out += view[0];
        break;
    }
  return out;
}

std::filesystem::path FramePattern::path(int frame, std::string_view view) const {
  return expanded(frame_text(frame), view);
}

std::optional<int> FramePattern::frame_of(const fs::path& file,
                                          std::string_view view) const {
  if (!has_frame_) return {};
  // What stands before the first frame token is known; the frame's digits follow it.
  const std::string name = file.string();
  const std::string with_mark = expanded(std::string(1, '\0'), view);
  const std::size_t mark = with_mark.find('\0');
  if (name.compare(0, mark, with_mark, 0, mark) != 0 || name.size() <= mark) return {};
  std::size_t end = mark + (name[mark] == '-' ? 1 : 0);
  while (end < name.size() && digit(name[end])) ++end;
  // Digits may go on in the text behind the token ("####2.exr"): the longest that writes
  // the same name again is the frame.
  for (; end > mark; --end) {
    const auto frame = read_frame(std::string_view(name).substr(mark, end - mark));
    if (frame && path(*frame, view) == file) return frame;
  }
  return {};
}

std::vector<int> FramePattern::existing(std::string_view view) const {
  std::vector<int> found;
  if (!has_frame_) return found;
  // The folder of the first component with a frame token is listed; each of its entries
  // may be one frame, whose whole path then must exist.
  const std::string with_mark = expanded(std::string(1, '\0'), view);
  const std::size_t mark = with_mark.find('\0');
  const std::size_t slash = with_mark.rfind('/', mark);
  const std::size_t begin = slash == std::string::npos ? 0 : slash + 1;
  const std::string folder = with_mark.substr(0, begin);
  const std::size_t end = std::min(with_mark.find('/', mark), with_mark.size());
  const FramePattern component = [&] {
    FramePattern p(*this);
    p.pieces_.clear();
    p.has_view_ = false;
    // Only this component's pieces, views filled in.
    std::string_view rest = std::string_view(with_mark).substr(begin, end - begin);
    while (!rest.empty()) {
      const std::size_t n = std::min(rest.find('\0'), rest.size());
      if (n > 0) p.pieces_.push_back({Piece::Is::text, std::string(rest.substr(0, n))});
      if (n < rest.size()) p.pieces_.push_back({Piece::Is::frame, {}});
      rest.remove_prefix(std::min(n + 1, rest.size()));
    }
    return p;
  }();
  std::error_code failed;
  fs::directory_iterator entry(folder.empty() ? "." : folder, failed);
  if (failed)
    throw Error(shown(folder.empty() ? "." : folder),
                "cannot be read: " + failed.message());
  for (; entry != fs::directory_iterator(); entry.increment(failed)) {
    if (const auto frame = component.frame_of(entry->path().filename())) {
      std::error_code missing;
      if (!fs::exists(path(*frame, view), missing)) continue;
      if (found.size() >= std::size_t(kMostFrames))
        throw Error(shown(text_),
                    "more than " + std::to_string(kMostFrames) + " files match");
      found.push_back(*frame);
    }
  }
  if (failed) throw Error(shown(folder), "cannot be read: " + failed.message());
  std::sort(found.begin(), found.end());
  return found;
}

bool is_frame_pattern(std::string_view path) {
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (frame_token(path, i).length > 0) return true;
    if (path[i] == '%' && i + 1 < path.size() &&
        (path[i + 1] == 'V' || path[i + 1] == 'v'))
      return true;
  }
  return false;
}

std::optional<int> frame_in_name(const fs::path& file) {
  const std::string name = file.filename().string();
  const std::size_t dot = name.rfind('.');
  const std::size_t end = dot == std::string::npos ? name.size() : dot;
  std::size_t begin = end;
  while (begin > 0 && digit(name[begin - 1])) --begin;
  if (begin == end) return {};
  const auto apart = [](char c) { return c == '.' || c == '_'; };
  if (begin > 0 && name[begin - 1] == '-') {
    // A sign only behind another mark; else the minus is the mark ("shot-1001").
    if (begin == 1 || apart(name[begin - 2])) --begin;
  } else if (begin > 0 && !apart(name[begin - 1]))
    return {};
  return read_frame(std::string_view(name).substr(begin, end - begin));
}

void check_output(const FramePattern& in, const FramePattern& out, std::size_t frames,
                  std::size_t views, const std::string& where) {
  const fs::path path = out.text();
  const auto with = [&](const char* token) {
    return "write " + path.stem().string() + "." + token + path.extension().string();
  };
  const std::string at = where + " " + shown(out.text());
  if (frames > 1 && !out.has_frame())
    throw Error(at, std::to_string(frames) + " frames into one file", with("####"));
  if (views > 1 && !out.has_view())
    throw Error(at, std::to_string(views) + " views into one file", with("%V"));
  if (path.lexically_normal() == fs::path(in.text()).lexically_normal())
    throw Error(at, "is the input itself", "write to another name");
}

}  // namespace brume
