#pragma once
// Ways to do what a surface or lens stage does to a frame's pixels. Internal to
// src/study.

#include <functional>
#include <string>
#include <vector>

#include "study/sheet.h"

namespace brume::study {

/// Changes the pixels.
using PixelWay = std::function<void(Sheet&)>;
/// One setting of a way, and what it made of the pixels.
struct Candidate {
  PixelWay way;
  Point point;
  std::vector<float> out[3];  // of the sheet's layout
  std::vector<double> seconds;
};
/// A method along its settings.
struct Line {
  MethodKind kind;
  std::string name;
  std::vector<Candidate> candidates;
};

/// Runs it once on a fresh copy; seconds of all cores.
double run(Candidate&, const Sheet& given);

/// Ours along the tolerance and the stage's own knob; settings of the same bits once. The
/// first line's last candidate is the finest.
void add_ours(const Context&, const std::string& name, const Sheet&, std::vector<Line>&);

/// Its source document's, and of a lens that is linear its own pattern summed over
/// windows; why there is none goes to the subject's notes. `stage` outlives the lines.
void add_others(const RunningStage& stage, const Sheet&, std::vector<Line>&, Subject&);

}  // namespace brume::study
