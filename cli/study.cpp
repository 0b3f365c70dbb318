// brume study: error against run time on a frame.

#include "study/study.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdio>
#include <filesystem>

#include "commands.h"
#include "image/atomic_file.h"
#include "jobs.h"
#include "num/error.h"
#include "scene.h"
#include "study/chart.h"
#include "study/page.h"
#include "study/report.h"
#include "table.h"

namespace brume::cli {
namespace fs = std::filesystem;

namespace {

// "0.5s", "20ms", "0.5" as seconds.
double seconds_from(const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [at, wrong] = std::from_chars(text.data(), end, value);
  const std::string unit(at, end);
  const double scale = unit.empty() || unit == "s" ? 1
                       : unit == "ms"              ? 1e-3
                       : unit == "us"              ? 1e-6
                                                   : 0;
  if (wrong != std::errc() || scale == 0 || !(value > 0))
    throw UsageError("study: --budget " + text + ": write a time, as 0.5s or 20ms");
  return value * scale;
}

void write(const fs::path& file, const std::string& text) {
  if (file.has_parent_path()) fs::create_directories(file.parent_path());
  AtomicFile out(file);
  out.append(text.data(), text.size());
  out.commit();
}

// All that will be written, so that nothing is half there when something is in the way.
void refuse_existing(const StudyArguments& a, const std::vector<fs::path>& files) {
  std::error_code none;
  for (const fs::path& f : files) {
    if (fs::is_directory(f, none)) throw Error(f.string(), "is a directory");
    if (!a.overwrite && fs::exists(f, none))
      throw Error(f.string(), "exists", "--overwrite replaces it");
  }
}

bool print_choice(const study::Choice& c, const std::string& asked) {
  const auto text = [](const study::Point& p) {
    return fmt::format("{} for the frame, worst error {}", study::time_text(p.seconds),
                       study::number_text(p.color.max));
  };
  if (!c.point) {
    fmt::print("{}: nothing; the nearest is {}: {}\n", asked, c.nearest->setting,
               text(*c.nearest));
    return false;
  }
  fmt::print("{}: {}: {}\n", asked, c.point->setting, text(*c.point));
  std::string set;
  for (const std::string& s : c.point->set) set += " --set " + s;
  if (set.empty()) set = " (the scene as it is)";
  fmt::print(" {}\n", set);
  return true;
}

void print_tables(const study::Study& s) {
  for (const study::Subject& subject : s.subjects) {
    fmt::print("{}{}: {} rays; {}\n", subject.name,
               subject.whole && s.subjects.size() > 1 ? ", all together" : "",
               subject.rays, subject.reference);
    std::fputs(table(cells(s, subject)).c_str(), stdout);
    for (const std::string& note : subject.notes) fmt::print("  {}\n", note);
  }
  for (const std::string& note : s.notes) fmt::print("{}\n", note);
}

}  // namespace

int study(const StudyArguments& a, const Terminal& terminal) {
  std::optional<double> budget;
  if (!a.budget.empty()) budget = seconds_from(a.budget);
  std::vector<fs::path> outputs;
  const fs::path folder = fs::path(a.out).parent_path();
  if (!a.out.empty()) outputs = {a.out, folder / "study.csv", folder / "study.json"};
  for (const std::string& one : {a.chart, a.table})
    if (!one.empty()) outputs.emplace_back(one);
  refuse_existing(a, outputs);

  LoadedScene loaded = load_scene(a.scene);
  const Job job = find_inputs({a.in}, "", false, terminal).front();
  study::Options options;
  options.frame = a.frame.value_or(job.frame);
  options.seconds = a.seconds;
  options.repeats = a.repeats;
  options.baselines = outputs.size() > 0 || (!budget && !a.error);
  options.pictures = !a.out.empty();
  options.progress = [&](const std::string& what) { terminal.status("study: " + what); };
  const study::Study s = study::run(loaded.scene, *loaded.registry, job.in, options);
  terminal.status("");

  if (!a.out.empty()) {
    write(outputs[1], study::csv(s));
    const std::string json = study::json(s, a.command);
    write(outputs[2], json);
    write(outputs[0], page(s, json, a.command, study::find_uplot()));
  }
  if (!a.chart.empty()) write(a.chart, chart_svg(s, s.whole()));
  if (!a.table.empty()) write(a.table, markdown(s, s.whole()));
  bool found = true;
  if (budget) found = print_choice(choose_by_time(s, *budget), "within " + a.budget);
  if (a.error)
    found =
        print_choice(choose_by_error(s, *a.error), fmt::format("error {:g}", *a.error)) &&
        found;
  if (outputs.empty() && !budget && !a.error) print_tables(s);
  terminal.detail(fmt::format("{:.1f} s", s.seconds));
  return found ? kOk : kFailed;
}

}  // namespace brume::cli
