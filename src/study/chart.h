#pragma once
// A subject's chart as SVG: error against time, both logarithmic.

#include <string>

#include "study/study.h"

namespace brume::study {

/// Stands alone, or inside a page. Every method is a line in its own colour and shape,
/// every point says on hover what it is; bars along time are the quartiles. An error of 0
/// lies on the lower edge.
std::string chart_svg(const Study&, const Subject&);

/// The colour of a method's line, "#rrggbb": the same in every chart.
const char* color_of(MethodKind);

/// For text inside markup.
std::string escaped(const std::string&);

}  // namespace brume::study
