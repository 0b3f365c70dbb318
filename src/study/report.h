#pragma once
// A study as data and as text.

#include <optional>
#include <string>
#include <vector>

#include "study/study.h"

namespace brume::study {

/// One row per point; its first line names the columns and their units.
std::string csv(const Study&);
/// Everything but the pictures. `command` is what was typed.
std::string json(const Study&, const std::string& command);

/// A subject's points as cells, best first line the headings; what tables show.
std::vector<std::vector<std::string>> cells(const Study&, const Subject&);
/// The same as a table for a README.
std::string markdown(const Study&, const Subject&);

/// "1.3 ns", "0.42 s"; three digits.
std::string time_text(double seconds);
std::string number_text(double);

/// Of ours in the whole scene: the settings with the least error within `seconds`, or the
/// fastest whose error is at most `error`.
struct Choice {
  const Point* point = nullptr;    ///< null: none
  const Point* nearest = nullptr;  ///< the fastest, or the most accurate there is
};
Choice choose_by_time(const Study&, double seconds);
Choice choose_by_error(const Study&, double error);

}  // namespace brume::study
