// brume plan: what apply would do, and why.

#include <fmt/format.h>

#include <cmath>
#include <cstdio>

#include "commands.h"
#include "jobs.h"
#include "json.h"
#include "pipeline/frame_file.h"
#include "scene.h"
#include "table.h"

namespace brume::cli {

namespace {

std::string joined(const std::vector<std::string>& list) {
  std::string out;
  for (const std::string& s : list) out += (out.empty() ? "" : ", ") + s;
  return out.empty() ? "none" : out;
}

// " 12 m to 8300 m" where a stage matters in part of the depth only.
std::string distances(const StagePlan& s) {
  if (s.nearest <= 0 && std::isinf(s.farthest)) return "";
  return fmt::format(
      "{:.4g} m to {}", s.nearest,
      std::isinf(s.farthest) ? "infinity" : fmt::format("{:.4g} m", s.farthest));
}

std::string window_text(const Window& w) {
  return fmt::format("x {}..{}, y {}..{}", w.x, w.right() - 1, w.y, w.bottom() - 1);
}

// Each knob, how it came to its value, and the error it promises.
void print_accuracy(const Plan& plan) {
  fmt::print("accuracy: |dC| <= {:.2g} (white + |C|) promised, {:g} asked for\n",
             plan.promised, plan.tolerance);
  std::vector<std::vector<std::string>> rows;
  for (const KnobPlan& k : plan.knobs)
    rows.push_back({k.name, k.none ? "" : fmt::format("{:g}", k.value),
                    k.none    ? "no knob"
                    : k.given ? "given"
                              : "from tolerance",
                    fmt::format("promises {:.2g}", k.promised)});
  std::fputs(table(rows).c_str(), stdout);
}

void print_plan(const Job& job, const Plan& plan) {
  fmt::print("{}, frame {}\n", job.in.string(), job.frame);
  for (const std::string& d : plan.decisions) fmt::print("  {}\n", d);
  fmt::print("stages\n");
  std::vector<std::vector<std::string>> rows;
  for (const StagePlan& s : plan.stages) {
    std::string where = s.runs ? distances(s) : "";
    if (s.runs && s.screen.width > 0)
      where += (where.empty() ? "" : ", ") + window_text(s.screen);
    rows.push_back({s.name == s.type ? s.name : s.name + " (" + s.type + ")",
                    s.runs ? "runs" : "left out", s.reason, where});
  }
  std::fputs(table(rows).c_str(), stdout);
  if (!plan.air.empty()) fmt::print("air\n");
  for (const std::string& line : plan.air) fmt::print("  {}\n", line);
  if (!plan.knobs.empty()) print_accuracy(plan);
  fmt::print("channels\n");
  std::fputs(table({{"read", joined(plan.channels_read)},
                    {"written", joined(plan.channels_written)},
                    {"passed on", joined(plan.channels_left)}})
                 .c_str(),
             stdout);
  if (plan.changes_nothing)
    fmt::print("nothing changes: the file is copied\n");
  else if (!plan.active.empty())
    fmt::print("pixels that may change: {}{}\n", window_text(plan.active),
               plan.whole_frame ? "; the frame is held whole" : "");
}

void write_json(Json& json, const Job& job, const Plan& plan) {
  json.object().key("file").value(job.in.string()).key("frame").value(job.frame);
  json.key("decisions").values(plan.decisions).key("stages").array();
  for (const StagePlan& s : plan.stages) {
    json.object().key("name").value(s.name).key("type").value(s.type);
    json.key("runs").value(s.runs).key("reason").value(s.reason);
    json.key("reads").values(s.reads);
    json.key("nearest").value(s.nearest).key("farthest").value(s.farthest);
    json.key("screen").values(
        std::vector<int>{s.screen.x, s.screen.y, s.screen.width, s.screen.height});
    json.end();
  }
  json.end().key("air").values(plan.air);
  json.key("tolerance").value(plan.tolerance).key("promised").value(plan.promised);
  json.key("knobs").array();
  for (const KnobPlan& k : plan.knobs) {
    json.object().key("name").value(k.name);
    if (!k.none) json.key("value").value(k.value);
    json.key("promised").value(k.promised).key("given").value(k.given).end();
  }
  json.end();
  json.key("read").values(plan.channels_read);
  json.key("written").values(plan.channels_written);
  json.key("passed_on").values(plan.channels_left);
  json.key("changes_nothing").value(plan.changes_nothing);
  json.key("whole_frame").value(plan.whole_frame);
  json.key("active").values(std::vector<int>{plan.active.x, plan.active.y,
                                             plan.active.width, plan.active.height});
  json.end();
}

}  // namespace

int plan(const PlanArguments& a, const Terminal& terminal) {
  LoadedScene loaded = load_scene(a.scene);
  const std::vector<Job> jobs = find_inputs(a.in, a.frames, false, terminal);
  const Session session(std::move(loaded.scene), *loaded.registry);
  Json json;
  if (a.json) json.array();
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const Plan p = plan_frame(session, jobs[i].frame, jobs[i].in);
    if (a.json) {
      write_json(json, jobs[i], p);
    } else {
      if (i > 0) std::fputc('\n', stdout);
      print_plan(jobs[i], p);
    }
  }
  if (a.json) std::fputs(json.end().text().c_str(), stdout);
  return kOk;
}

}  // namespace brume::cli
