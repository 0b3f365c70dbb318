// brume apply --check N: is the tolerance of the scene kept on this frame?

#include "truth/check.h"

#include <fmt/format.h>

#include <cstdio>

#include "commands.h"
#include "image/atomic_file.h"
#include "jobs.h"
#include "json.h"
#include "scene.h"

namespace brume::cli {

namespace {

void print(const Job& job, const truth::Check& c) {
  fmt::print("{}: |dC| <= {:g} ({:g} + |C|) promised, {} pixels by the truth\n",
             job.in.string(), c.promised, c.white, c.pixels);
  if (c.classes.empty()) {
    fmt::print("  the scene changes nothing here\n");
    return;
  }
  fmt::print("  {:<12}{:>7}{:>10}{:>10}   {}\n", "", "pixels", "worst", "p99",
             "error of S, T, L and colour where it is worst");
  for (const truth::CheckClass& k : c.classes)
    fmt::print(
        "  {:<12}{:>7}{:>9.3g}%{:>9.3g}%   {:.2g}, {:.2g}, {:.2g}, {:.2g} at {},{}\n",
        k.name, k.pixels, 100 * k.worst, 100 * k.p99, k.dS, k.dT, k.dL, k.dC, k.x, k.y);
  if (c.unconverged > 0)
    fmt::print("  the truth did not converge on {} of them\n", c.unconverged);
  if (c.undecided > 0)
    fmt::print(
        "  {} of them are left open: the last bits of depth and directions decide "
        "what surface stages make of them\n",
        c.undecided);
  for (const std::string& stage : c.unproven)
    fmt::print("  {} has no truth: what it makes of the surfaces is taken as given\n",
               stage);
  fmt::print("  {}: {:.3g} % of what is promised (the truth is good to {:.1g} %)\n",
             c.kept() ? "kept" : "BROKEN", 100 * c.worst, 100 * c.truth_error);
}

void write_json(Json& j, const Job& job, const truth::Check& c) {
  j.object().key("in").value(job.in.string()).key("frame").value(job.frame);
  j.key("promised").value(c.promised).key("white").value(c.white);
  j.key("pixels").value(c.pixels).key("kept").value(c.kept());
  j.key("worst").value(c.worst).key("truth_error").value(c.truth_error);
  j.key("unconverged").value(c.unconverged).key("undecided").value(c.undecided);
  j.key("unproven").values(c.unproven).key("classes").array();
  for (const truth::CheckClass& k : c.classes) {
    j.object().key("name").value(k.name).key("pixels").value(k.pixels);
    j.key("worst").value(k.worst).key("p99").value(k.p99);
    j.key("x").value(k.x).key("y").value(k.y);
    j.key("dS")
        .value(k.dS)
        .key("dT")
        .value(k.dT)
        .key("dL")
        .value(k.dL)
        .key("dC")
        .value(k.dC)
        .end();
  }
  j.end().end();
}

}  // namespace

int check(const ApplyArguments& a, const Terminal& terminal) {
  if (!a.out.empty() || a.truth || a.region || a.proxy > 1)
    throw UsageError(
        "apply: --check writes nothing and looks at whole frames: no "
        "--output, --truth, --region or --proxy");
  LoadedScene loaded = load_scene(a.scene);
  const std::vector<Job> jobs = find_inputs(a.in, a.frames, a.skip_missing, terminal);
  const Session session(std::move(loaded.scene), *loaded.registry);
  bool kept = true;
  Json json;
  json.array();
  for (const Job& job : jobs) {
    const truth::Check c = truth::check_frame(session, job.frame, job.in, a.check);
    kept = kept && c.kept();
    write_json(json, job, c);
    if (a.report != "-" && terminal.loudness != Loudness::quiet) print(job, c);
  }
  const std::string text = json.end().text();
  if (a.report == "-") {
    std::fputs(text.c_str(), stdout);
  } else if (!a.report.empty()) {
    AtomicFile out(a.report);
    out.append(text.data(), text.size());
    out.commit();
  }
  return kept ? kOk : kFailed;
}

}  // namespace brume::cli
