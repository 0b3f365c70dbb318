#pragma once
// One subject of a study: the media of a stage, or of the whole scene. Internal to
// src/study.

#include <chrono>

#include "study/prepared.h"

namespace brume::study {

using Clock = std::chrono::steady_clock;

/// Everything that is the same for all subjects.
struct Context {
  const Options& options;
  double pixels, white, far;
  const Rays& rays;
  const Prepared& given;
  const std::vector<Prepared>& settings;
  const Prepared& finest;
  const Prepared* by_ray;
  /// When this subject should be done, by the clock on the wall, and the part of that
  /// time that goes to timing.
  Clock::time_point end = {};
  double timing_seconds = 0;

  double left() const {
    return std::chrono::duration<double>(end - Clock::now()).count();
  }
  void say(const std::string& what) const {
    if (options.progress) options.progress(what);
  }
};

/// The name of stage k among those that run.
std::string stage_name(const PreparedFrame::Impl&, std::size_t k);

/// Every way to compute the media of `stage` ("" all of them), timed and held against
/// what is right.
Subject study_of(const Context&, const std::string& stage, const std::string& title);

}  // namespace brume::study
