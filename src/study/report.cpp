#include "study/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace brume::study {

namespace {

using Json = nlohmann::ordered_json;

// Points on the frontier of a subject, all methods together.
std::vector<const Point*> best_of(const Subject& s) {
  std::vector<const Point*> all, best;
  std::vector<Cost> costs;
  for (const Method& m : s.methods)
    for (const Point& p : m.points) all.push_back(&p);
  for (const Point* p : all) costs.push_back(p->cost());
  for (const std::size_t i : frontier(costs)) best.push_back(all[i]);
  return best;
}

bool among(const std::vector<const Point*>& list, const Point& p) {
  return std::find(list.begin(), list.end(), &p) != list.end();
}

Json number(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

Json to_json(const ErrorOf& e) {
  return {{"max", number(e.max)},
          {"p99", number(e.p99)},
          {"rms", number(e.rms)},
          {"mean", number(e.mean)}};
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + '"';
}

std::vector<const Point*> ours_of(const Study& s) {
  std::vector<const Point*> all;
  for (const Method& m : s.whole().methods)
    if (m.kind == MethodKind::ours)
      for (const Point& p : m.points) all.push_back(&p);
  return all;
}

std::vector<Cost> costs_of(const std::vector<const Point*>& points) {
  std::vector<Cost> costs;
  for (const Point* p : points) costs.push_back(p->cost());
  return costs;
}

}  // namespace

std::string number_text(double x) {
  if (x == 0) return "0";
  if (std::isnan(x)) return "-";
  return fmt::format("{:.2g}", x);
}

std::string time_text(double s) {
  const double a = std::abs(s);
  const auto [scale, unit] = a >= 1      ? std::pair(1., "s")
                             : a >= 1e-3 ? std::pair(1e3, "ms")
                             : a >= 1e-6 ? std::pair(1e6, "us")
                                         : std::pair(1e9, "ns");
  return fmt::format("{:.3g} {}", s * scale, unit);
}

std::string csv(const Study& study) {
  std::string out =
      "subject,kind,method,setting,once_s,frame_s,ns_per_pixel,ns_per_pixel_q1,"
      "ns_per_pixel_q3,seconds,color_max,color_p99,color_rms,color_mean,T_max,T_p99,"
      "T_rms,T_mean,L_max,L_p99,L_rms,L_mean,x,y,frontier\n";
  for (const Subject& s : study.subjects) {
    const auto best = best_of(s);
    for (const Method& m : s.methods)
      for (const Point& p : m.points) {
        out += fmt::format("{},{},{},{},{:g},{:g},{:g},{:g},{:g},{:g}", quoted(s.name),
                           name(m.kind), quoted(m.name), quoted(p.setting), p.once,
                           p.frame, 1e9 * p.per_pixel.median, 1e9 * p.per_pixel.low,
                           1e9 * p.per_pixel.high, p.seconds);
        for (const ErrorOf* e : {&p.color, &p.T, &p.L})
          out += fmt::format(",{:g},{:g},{:g},{:g}", e->max, e->p99, e->rms, e->mean);
        out += fmt::format(",{},{},{}\n", p.x, p.y, among(best, p) ? 1 : 0);
      }
  }
  return out;
}

std::string json(const Study& study, const std::string& command) {
  Json subjects = Json::array();
  for (const Subject& s : study.subjects) {
    const auto best = best_of(s);
    Json methods = Json::array();
    for (const Method& m : s.methods) {
      Json points = Json::array();
      for (const Point& p : m.points)
        points.push_back({{"setting", p.setting},
                          {"set", p.set},
                          {"once_seconds", p.once},
                          {"frame_seconds", p.frame},
                          {"ns_per_pixel",
                           {{"q1", 1e9 * p.per_pixel.low},
                            {"median", 1e9 * p.per_pixel.median},
                            {"q3", 1e9 * p.per_pixel.high}}},
                          {"seconds", p.seconds},
                          {"color", to_json(p.color)},
                          {"T", to_json(p.T)},
                          {"L", to_json(p.L)},
                          {"worst_pixel", {p.x, p.y}},
                          {"frontier", among(best, p)}});
      methods.push_back(
          {{"kind", name(m.kind)}, {"name", m.name}, {"points", std::move(points)}});
    }
    subjects.push_back({{"name", s.name},
                        {"whole_scene", s.whole},
                        {"reference", s.reference},
                        {"reference_error", number(s.reference_error)},
                        {"rays", s.rays},
                        {"grid", {s.grid_width, s.grid_height}},
                        {"notes", s.notes},
                        {"methods", std::move(methods)}});
  }
  const Json all = {{"brume", study.version},
                    {"command", command},
                    {"date", study.date},
                    {"machine",
                     {{"processor", study.machine},
                      {"cores", study.cores},
                      {"instructions", study.isa}}},
                    {"scene", study.scene},
                    {"in", study.in},
                    {"width", study.width},
                    {"height", study.height},
                    {"tolerance", study.tolerance},
                    {"white", study.white},
                    {"repeats", study.repeats},
                    {"seconds", study.seconds},
                    {"notes", study.notes},
                    {"subjects", std::move(subjects)}};
  return all.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::vector<std::vector<std::string>> cells(const Study&, const Subject& s) {
  std::vector<std::vector<std::string>> rows = {
      {"method", "setting", "a pixel", "noise", "the frame", "worst colour", "99 %",
       "rms", "worst T", "worst L", "frontier"}};
  const auto best = best_of(s);
  for (const Method& m : s.methods)
    for (const Point& p : m.points) {
      const double noise = (p.per_pixel.high - p.per_pixel.low) / 2 / p.per_pixel.median;
      rows.push_back(
          {&p == m.points.data() ? m.name : "", p.setting, time_text(p.per_pixel.median),
           fmt::format("{:.1f} %", 100 * noise), time_text(p.seconds),
           number_text(p.color.max), number_text(p.color.p99), number_text(p.color.rms),
           number_text(p.T.max), number_text(p.L.max), among(best, p) ? "*" : ""});
    }
  return rows;
}

std::string markdown(const Study& study, const Subject& s) {
  std::string out;
  const auto rows = cells(study, s);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (const std::string& cell : rows[r]) out += "| " + cell + " ";
    out += "|\n";
    if (r > 0) continue;
    for (std::size_t k = 0; k < rows[r].size(); ++k) out += "|---";
    out += "|\n";
  }
  return out;
}

Choice choose_by_time(const Study& study, double seconds) {
  const auto points = ours_of(study);
  const auto costs = costs_of(points);
  Choice c;
  if (const auto i = least_error_within(costs, seconds)) c.point = points[*i];
  if (const auto best = frontier(costs); !best.empty()) c.nearest = points[best.front()];
  return c;
}

Choice choose_by_error(const Study& study, double error) {
  const auto points = ours_of(study);
  const auto costs = costs_of(points);
  Choice c;
  if (const auto i = least_time_for(costs, error)) c.point = points[*i];
  if (const auto best = frontier(costs); !best.empty()) c.nearest = points[best.back()];
  return c;
}

}  // namespace brume::study
