// brume apply: frames in, frames with air out.

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <exception>
#include <mutex>
#include <thread>

#include "commands.h"
#include "image/atomic_file.h"
#include "interrupt.h"
#include "jobs.h"
#include "num/error.h"
#include "pipeline/frame_file.h"
#include "progress.h"
#include "scene.h"
#include "truth/frame.h"

namespace brume::cli {
namespace fs = std::filesystem;

namespace {

// Frames worked on at once: enough to hide the opening and closing of files, few enough
// to bound memory.
constexpr int kMostInFlight = 4;

// What exists is refused, or left alone, before anything runs.
void sort_out_existing(std::vector<Job>& jobs, const ApplyArguments& a,
                       const Terminal& terminal) {
  if (a.overwrite) return;
  std::error_code none;
  const auto there = [&](const Job& job) { return fs::exists(job.out, none); };
  if (a.skip_existing) {
    const std::size_t before = jobs.size();
    std::erase_if(jobs, there);
    if (before != jobs.size())
      terminal.say(
          fmt::format("{} of {} outputs exist and stay", before - jobs.size(), before));
    return;
  }
  const auto first = std::find_if(jobs.begin(), jobs.end(), there);
  if (first == jobs.end()) return;
  const auto count = std::count_if(jobs.begin(), jobs.end(), there);
  throw Error(first->out.string(),
              count == 1 ? "exists" : fmt::format("exists, as do {} more", count - 1),
              "--overwrite replaces, --skip-existing leaves what exists");
}

void make_folders(const std::vector<Job>& jobs, const Terminal& terminal) {
  for (const Job& job : jobs) {
    const fs::path folder = job.out.parent_path();
    std::error_code failed;
    if (folder.empty() || fs::is_directory(folder, failed)) continue;
    if (!fs::create_directories(folder, failed) && failed)
      throw Error(folder.string(), "cannot be made", failed.message());
    terminal.detail("made the folder " + folder.string());
  }
}

// Works through the jobs; several at once, each on its share of the threads.
class Run {
 public:
  Run(const ApplyArguments& a, const Session& session, const std::vector<Job>& jobs,
      const Terminal& terminal)
      : session_(session),
        jobs_(jobs),
        terminal_(terminal),
        progress_(terminal, jobs.size()) {
    options_.region = a.region;
    options_.proxy = a.proxy;
    options_.provenance_scene = print(session.scene());
    options_.cancel = &interrupted();
    by_truth_ = a.truth;
    threads_ = a.threads > 0 ? a.threads
                             : int(std::max(1u, std::thread::hardware_concurrency()));
  }

  void all() {
    const int in_flight =
        int(std::min<std::size_t>({std::size_t(threads_), kMostInFlight, jobs_.size()}));
    {
      std::vector<std::jthread> workers;
      for (int i = 1; i < in_flight; ++i)
        workers.emplace_back([this, in_flight] { work(in_flight); });
      work(in_flight);
    }
    if (broken_) std::rethrow_exception(broken_);
  }

  std::vector<FrameReport> reports;
  std::size_t failed = 0;
  double seconds() const { return progress_.seconds(); }

 private:
  void work(int in_flight) {
    while (!interrupted() && !stop_) {
      const std::size_t i = next_.fetch_add(1);
      if (i >= jobs_.size()) return;
      // The last frames share the threads that have nothing left to do.
      const int left =
          int(std::min<std::size_t>(jobs_.size() - i, std::size_t(in_flight)));
      try {
        one(i, (threads_ + left - 1) / left);
      } catch (...) {  // no memory, no threads: nothing that another frame would not meet
        const std::lock_guard lock(mutex_);
        if (!broken_) broken_ = std::current_exception();
        stop_ = true;
      }
    }
  }

  void one(std::size_t i, int threads) {
    const Job& job = jobs_[i];
    ApplyOptions options = options_;
    options.threads = threads;
    options.progress = [this, i](double fraction) { progress_.reached(i, fraction); };
    try {
      if (by_truth_) return one_by_truth(i, options);
      FrameReport report = apply_frame(session_, job.frame, job.in, job.out, options);
      progress_.over(i,
                     fmt::format("{}  {:.2f} s", job.out.string(), report.wall_seconds));
      if (report.copy.half_overflows > 0)
        terminal_.warning(
            fmt::format("{}: {} values beyond the largest half were written as 65504",
                        job.out.string(), report.copy.half_overflows));
      warn_of_losses(report);
      const std::lock_guard lock(mutex_);
      reports.push_back(std::move(report));
    } catch (const Error& e) {
      if (interrupted()) return;  // that is why
      progress_.over(i, "");
      terminal_.error(e.what());
      const std::lock_guard lock(mutex_);
      ++failed;
    }
  }

  // Once a run: layers are float because they are multiplied and added afterwards.
  void warn_of_losses(const FrameReport& report) {
    const std::vector<std::string>& layers = report.plan.lossy_layers;
    if (layers.empty() || report.out.extension() != ".exr" || warned_.exchange(true))
      return;
    terminal_.warning(
        fmt::format("{}: the file's compression is lossy, for the layers too ({}); "
                    "--compression zip keeps their values",
                    report.out.string(), fmt::join(layers, ", ")));
  }

  void one_by_truth(std::size_t i, const ApplyOptions& options) {
    const Job& job = jobs_[i];
    // A hundredth of what the fast way may be off by.
    truth::PixelOptions asked;
    asked.tolerance = std::min(1e-2 * session_.scene().tolerance, asked.tolerance);
    asked.enough = 1e-1 * session_.scene().tolerance;
    const truth::Rendered r =
        truth::apply_frame(session_, job.frame, job.in, job.out, options, asked);
    std::string notes;
    if (r.unconverged > 0) notes += fmt::format(", {} pixels did not", r.unconverged);
    if (r.undecided > 0)
      notes += fmt::format(", {} that the last bits of depth decide", r.undecided);
    for (const std::string& stage : r.unproven)
      notes += fmt::format(", {} taken as given", stage);
    progress_.over(
        i, fmt::format("{}  converged to {:.1g}{}", job.out.string(), r.error, notes));
    FrameReport report;
    report.in = job.in, report.out = job.out, report.frame = job.frame;
    report.plan = plan_frame(session_, job.frame, job.in);
    warn_of_losses(report);
    const std::lock_guard lock(mutex_);
    reports.push_back(std::move(report));
  }

  const Session& session_;
  bool by_truth_ = false;
  const std::vector<Job>& jobs_;
  const Terminal& terminal_;
  Progress progress_;
  ApplyOptions options_;
  int threads_ = 1;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> stop_{false}, warned_{false};
  std::mutex mutex_;
  std::exception_ptr broken_;
};

void write_report(const std::string& file, const std::string& json) {
  if (file == "-") {
    std::fputs(json.c_str(), stdout);
    return;
  }
  AtomicFile out(file);
  out.append(json.data(), json.size());
  out.commit();
}

}  // namespace

int apply(const ApplyArguments& a, const Terminal& terminal) {
  if (a.check > 0) return check(a, terminal);
  if (a.out.empty())
    throw UsageError("apply: --output is required; see brume apply --help");
  if (a.truth && (a.region || a.proxy > 1))
    throw UsageError("apply: --truth renders whole frames; make a small one first");
  if (a.truth && !a.report.empty())
    throw UsageError("apply: --report is of the fast way; --truth says what it reached");
  if (a.overwrite && a.skip_existing)
    throw UsageError("--overwrite and --skip-existing: one or the other");
  LoadedScene loaded = load_scene(a.scene);
  std::vector<Job> jobs = find_inputs(a.in, a.frames, a.skip_missing, terminal);
  name_outputs(jobs, a.out);
  sort_out_existing(jobs, a, terminal);
  if (jobs.empty()) {
    terminal.say("Nothing to do");
    return kOk;
  }
  catch_interrupts();
  make_folders(jobs, terminal);

  const Session session(std::move(loaded.scene), *loaded.registry);
  Run run(a, session, jobs, terminal);
  run.all();
  const double seconds = run.seconds();
  std::sort(run.reports.begin(), run.reports.end(),
            [](const FrameReport& x, const FrameReport& y) { return x.frame < y.frame; });
  if (!a.report.empty()) write_report(a.report, report_json(run.reports, seconds));

  const std::size_t done = run.reports.size();
  if (interrupted()) {
    terminal.error(
        fmt::format("interrupted; {} of {} frames written{}", done, jobs.size(),
                    jobs.size() > 1 ? "; --skip-existing makes the others" : ""));
    return kInterrupted;
  }
  if (jobs.size() > 1)
    terminal.say(fmt::format("{} frames in {:.2f} s, {:.3g} frames/s{}", done, seconds,
                             double(done) / seconds,
                             run.failed ? fmt::format("; {} failed", run.failed) : ""));
  if (run.failed == 0) return kOk;
  return done == 0 ? kFailed : kSomeFramesFailed;
}

}  // namespace brume::cli
