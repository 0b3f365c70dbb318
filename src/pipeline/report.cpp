#include "pipeline/report.h"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace brume {
namespace {

using Json = nlohmann::ordered_json;

const char* name(brume_role role) {
  return role == BRUME_SURFACE ? "surface" : role == BRUME_AIR ? "air" : "lens";
}

Json number(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

Json window(const Window& w) {
  return w.empty() ? Json(nullptr) : Json{w.x, w.y, w.width, w.height};
}

Json to_json(const Plan& plan) {
  Json stages = Json::array();
  for (const StagePlan& s : plan.stages) {
    Json j{{"name", s.name}, {"type", s.type}, {"runs", s.runs}, {"why", s.reason}};
    if (s.runs) {
      j["role"] = name(s.role);
      if (!s.reads.empty()) j["reads"] = s.reads;
      if (!s.screen.empty()) j["screen"] = window(s.screen);
      j["nearest"] = number(s.nearest);
      j["farthest"] = number(s.farthest);  // null: no end
    }
    stages.push_back(std::move(j));
  }
  Json knobs = Json::array();
  for (const KnobPlan& k : plan.knobs)
    knobs.push_back({{"name", k.name},
                     {"value", k.none ? Json(nullptr) : Json(k.value)},
                     {"promised", number(k.promised)},
                     {"given", k.given}});
  return {{"frame", plan.frame},
          {"changes_nothing", plan.changes_nothing},
          {"whole_frame", plan.whole_frame},
          {"active", window(plan.active)},
          {"stages", std::move(stages)},
          {"air", plan.air},
          {"tolerance", plan.tolerance},
          {"promised", number(plan.promised)},
          {"knobs", std::move(knobs)},
          {"decisions", plan.decisions},
          {"channels_read", plan.channels_read},
          {"channels_written", plan.channels_written},
          {"channels_left", plan.channels_left}};
}

Json to_json(const FrameReport& r) {
  const double pixels = double(std::max<std::uint64_t>(1, r.counts.pixels));
  const auto step = [&](double seconds) {
    return Json{{"seconds", seconds}, {"ns_per_pixel", seconds * 1e9 / pixels}};
  };
  return {{"in", r.in.string()},
          {"out", r.out.string()},
          {"frame", r.frame},
          {"wall_seconds", r.wall_seconds},
          {"steps",  // summed over threads
           {{"prepare", step(r.prepare_seconds)},
            {"read", step(r.copy.read_seconds)},
            {"apply", step(r.work_seconds)},
            {"write", step(r.copy.write_seconds)}}},
          {"pixels", r.counts.pixels},
          {"pixels_in_touched_bands", r.counts.touched},
          {"bytes_read", r.copy.bytes_read},
          {"bytes_written", r.copy.bytes_written},
          {"chunks", r.copy.chunks},
          {"chunks_copied", r.copy.chunks_copied},
          {"streamed", r.copy.streamed},
          {"half_overflows", r.copy.half_overflows},
          {"plan", to_json(r.plan)}};
}

/// File names need not be UTF-8; what is not becomes U+FFFD.
std::string text(const Json& j, int indent) {
  return j.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

const char* version() { return BRUME_VERSION; }

std::string plan_json(const Plan& plan) { return text(to_json(plan), -1); }

std::string report_json(std::span<const FrameReport> reports, double wall_seconds) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return double(t.tv_sec) + 1e-6 * double(t.tv_usec);
  };
  Json frames = Json::array();
  for (const FrameReport& r : reports) frames.push_back(to_json(r));
  return text({{"brume", version()},
               {"wall_seconds", wall_seconds},
               {"cpu_seconds", seconds(usage.ru_utime) + seconds(usage.ru_stime)},
               {"peak_memory_bytes",
                std::uint64_t(usage.ru_maxrss) * 1024},  // Linux counts in KB
               {"frames", std::move(frames)}},
              2) +
         "\n";
}

}  // namespace brume
