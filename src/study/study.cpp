#include "study/study.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <thread>

#include "num/error.h"
#include "pipeline/report.h"
#include "stage/registry.h"
#include "study/pixel_subject.h"
#include "study/reference.h"
#include "study/show.h"
#include "study/subject.h"

namespace brume::study {

namespace {

// Held in memory; of larger frames fewer rows.
constexpr std::int64_t kMostRays = 2'200'000;

double since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

std::string processor() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown processor";
}

}  // namespace

const char* name(MethodKind k) {
  constexpr const char* kNames[] = {"ours", "source", "marching", "painting"};
  return kNames[int(k)];
}

Study run(const SceneFile& scene, Registry& registry, const std::filesystem::path& in,
          const Options& options) {
  const auto begin = Clock::now();
  const FrameFiles files(scene, options.frame, in);
  const Window data = files.main().header().data_window;
  const Preparer preparer(scene, registry, files);
  if (options.progress) options.progress("preparing");
  const Prepared given = preparer.given();
  const PreparedFrame::Impl& f = given.impl();

  Study study;
  study.scene = scene.path.string();
  study.in = in.string();
  study.version = version();
  study.machine = processor();
  study.cores = int(std::thread::hardware_concurrency());
  study.isa = std::string("x86-64-") + brume::name(isa());
  study.date = fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr)));
  study.width = data.width;
  study.height = data.height;
  study.tolerance = scene.tolerance;
  study.white = SceneFile::section<OutputSection>(scene.output, options.frame).white;
  study.repeats = options.repeats;

  std::vector<std::string> stages, pixel_stages;  // those with media; surface and lens
  for (const StagePlan& plan : f.plan.stages)
    if (!plan.runs) study.notes.push_back(plan.name + ": " + plan.reason);
  for (std::size_t k = 0; k < f.stages.size(); ++k) {
    const std::string who = stage_name(f, k);
    const bool has_media = std::any_of(f.world.media.begin(), f.world.media.end(),
                                       [&](const auto& m) { return m.stage == int(k); });
    if (has_media)
      stages.push_back(who);
    else if (f.stages[k].role != BRUME_AIR)
      pixel_stages.push_back(who);
    else
      study.notes.push_back(who + ": is no air of its own; it counts in the whole scene");
  }
  if (stages.empty() && pixel_stages.empty())
    throw Error(in.string(), "no stage does anything to this frame",
                "brume plan says why");

  const int step = int(std::max<std::int64_t>(1, data.pixels() / kMostRays));
  const Rays rays = read_rays(f, files, step);
  const std::vector<Prepared> settings = preparer.along_knobs();
  const Prepared finest = preparer.finest();
  std::optional<Prepared> by_ray;
  if (Judge::has_alone(f.world))
    by_ray = preparer.finest_by_ray(*given.made, options.frame);

  double far = 0;
  for (std::size_t i = 0; i < rays.count; ++i)
    if (std::isfinite(rays.t[i])) far = std::max(far, double(rays.t[i]));
  std::size_t subjects =
      (stages.size() > 1 ? stages.size() + 1 : stages.size()) + pixel_stages.size();
  Context c{options,
            double(data.pixels()),
            study.white,
            far > 0 ? 2 * far : 1e5,
            rays,
            given,
            settings,
            finest,
            by_ray ? &*by_ray : nullptr};
  // What is left is shared evenly; a subject that takes less leaves more to the next.
  const auto next = [&]() -> const Context& {
    const double share =
        std::max(0., options.seconds - since(begin)) / double(subjects--);
    c.end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                               std::chrono::duration<double>(share));
    c.timing_seconds = 0.5 * share;
    return c;
  };
  if (stages.size() > 1)
    for (const std::string& stage : stages)
      study.subjects.push_back(study_of(next(), stage, stage));
  for (const std::string& stage : pixel_stages) {
    std::string why_not;
    auto subject = study_of_pixels(next(), stage, scene, registry, files, why_not);
    if (subject)
      study.subjects.push_back(std::move(*subject));
    else
      study.notes.push_back(stage + ": " + why_not);
  }
  if (!stages.empty())
    study.subjects.push_back(
        study_of(next(), "", stages.size() == 1 ? stages[0] : std::string("scene")));
  if (study.subjects.empty())
    throw Error(in.string(), "nothing here can be studied", study.notes.back());
  if (options.pictures) {
    if (options.progress) options.progress("pictures");
    show(scene, registry, files, given, study);
  }
  study.seconds = since(begin);
  return study;
}

}  // namespace brume::study
