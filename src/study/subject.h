#pragma once
// One subject of a study: the media of a stage, or of the whole scene. Internal to
// src/study.

#include "study/prepared.h"

namespace brume::study {

/// Everything that is the same for all subjects.
struct Context {
  const Options& options;
  double pixels, white, far;
  const Rays& rays;
  const Prepared& given;
  const std::vector<Prepared>& settings;
  const Prepared& finest;
  const Prepared* by_ray;
  double truth_seconds, timing_seconds;

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
