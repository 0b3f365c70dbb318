#pragma once
// Messages for people, on standard error; data goes to standard output. Colour only on a
// terminal and without NO_COLOR.

#include <string>
#include <string_view>

namespace brume::cli {

enum class Loudness { quiet, normal, verbose };

class Terminal {
 public:
  Loudness loudness = Loudness::normal;

  Terminal();

  bool shows_progress() const { return terminal_ && loudness != Loudness::quiet; }
  int columns() const;  ///< of the terminal; 80 where it cannot tell

  void error(std::string_view) const;    ///< always: "brume: ..."
  void warning(std::string_view) const;  ///< unless quiet
  void say(std::string_view) const;      ///< unless quiet
  void detail(std::string_view) const;   ///< with -v

  /// Replaces the progress line at the bottom of the terminal; "" removes it. Messages
  /// go above it.
  void status(std::string_view) const;

 private:
  void line(std::string_view colour, std::string_view mark, std::string_view text) const;

  bool terminal_, colour_;
  mutable bool status_shown_ = false;
};

}  // namespace brume::cli
