#include "terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <mutex>

namespace brume::cli {

namespace {

// One message at a time, whatever thread it comes from.
std::mutex& guard() {
  static std::mutex m;
  return m;
}

// One write: lines of several programs on one terminal do not mix.
void put(const std::string& text) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t n = ::write(STDERR_FILENO, text.data() + done, text.size() - done);
    if (n <= 0) return;  // nobody listens
    done += std::size_t(n);
  }
}

constexpr std::string_view kClearLine = "\r\033[K";

}  // namespace

Terminal::Terminal() {
  const char* term = std::getenv("TERM");
  const char* no_color = std::getenv("NO_COLOR");
  terminal_ = ::isatty(STDERR_FILENO) && term && std::string_view(term) != "dumb";
  colour_ = terminal_ && !(no_color && *no_color);
}

int Terminal::columns() const {
  winsize size{};
  if (::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0)
    return size.ws_col;
  return 80;
}

void Terminal::line(std::string_view colour, std::string_view mark,
                    std::string_view text) const {
  std::string all;
  const std::lock_guard lock(guard());
  if (status_shown_) all += kClearLine;
  status_shown_ = false;
  if (colour_ && !colour.empty()) all += colour;
  all += mark;
  if (colour_ && !colour.empty()) all += "\033[0m";
  all += text;
  all += '\n';
  put(all);
}

void Terminal::error(std::string_view text) const { line("\033[1;31m", "brume: ", text); }

void Terminal::warning(std::string_view text) const {
  if (loudness != Loudness::quiet) line("\033[1;33m", "brume: ", text);
}

void Terminal::say(std::string_view text) const {
  if (loudness != Loudness::quiet) line("", "", text);
}

void Terminal::detail(std::string_view text) const {
  if (loudness == Loudness::verbose) line("\033[2m", "", text);
}

void Terminal::status(std::string_view text) const {
  if (!shows_progress()) return;
  const std::lock_guard lock(guard());
  if (text.empty() && !status_shown_) return;
  status_shown_ = !text.empty();
  put(std::string(kClearLine) + std::string(text));
}

}  // namespace brume::cli
