#pragma once
// A study as one page that needs nothing else.

#include <filesystem>
#include <string>

#include "study/study.h"

namespace brume::study {

/// uPlot (MIT licence, https://github.com/leeoniya/uPlot), as it was found when brume was
/// built; empty where it was not.
struct Uplot {
  std::string script, style, licence;
};
/// Looks for it beside the program and where brume is installed (share/brume/uplot). Not
/// found: empty. BRUME_UPLOT names another folder.
Uplot find_uplot();

/// The page: charts (SVG that uPlot, where it is given, replaces by ones to hover and
/// zoom), tables, the frame before and after, errors in false colour, and what made it.
/// `json` is the study's own (report.h): the page holds it too, and scripts read it.
std::string page(const Study&, const std::string& json, const std::string& command,
                 const Uplot&);

}  // namespace brume::study
