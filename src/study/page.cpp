#include "study/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "picture/png.h"
#include "study/assets.h"
#include "study/chart.h"
#include "study/report.h"

namespace brume::study {

namespace {

std::string image(const Picture& p, const std::string& alt) {
  return fmt::format(
      "<img alt='{}' width='{}' height='{}' src='data:image/png;base64,{}'>",
      escaped(alt), p.width, p.height, base64(png(p)));
}

// Text inside <script> must not end it.
std::string in_script(std::string text) {
  for (std::size_t at = 0; (at = text.find("</", at)) != std::string::npos; at += 3)
    text.replace(at, 2, "<\\/");
  return text;
}

std::string table_of(const Study& study, const Subject& s) {
  const auto rows = cells(study, s);
  std::string out = "<div class='scroll'><table><thead><tr>";
  for (std::size_t k = 0; k + 1 < rows[0].size(); ++k)
    out += "<th>" + escaped(rows[0][k]) + "</th>";
  out += "</tr></thead><tbody>";
  std::size_t r = 1;
  for (const Method& m : s.methods)
    for (std::size_t i = 0; i < m.points.size(); ++i, ++r) {
      const auto& row = rows[r];
      out += row.back().empty() ? "<tr>" : "<tr class='best'>";
      for (std::size_t k = 0; k + 1 < row.size(); ++k) {
        const std::string dot =
            k == 0 && i == 0
                ? fmt::format("<i style='background:{}'></i>", color_of(m.kind))
                : "";
        out += "<td>" + dot + escaped(row[k]) + "</td>";
      }
      out += "</tr>";
    }
  return out + "</tbody></table></div>";
}

// The point that stands for a method in pictures: what the scene asks for, else the one
// that takes about as long as ours.
const Point& typical(const Subject& s, const Method& m) {
  if (m.kind == MethodKind::ours) {
    for (const Point& p : m.points)
      if (p.setting == "as the scene says" || p.setting == "tolerance 0.001") return p;
    return m.points.back();
  }
  const double goal = typical(s, s.methods.front()).seconds;
  const Point* best = &m.points.front();
  for (const Point& p : m.points)
    if (std::abs(std::log(p.seconds / goal)) < std::abs(std::log(best->seconds / goal)))
      best = &p;
  return *best;
}

constexpr double kDarkest = 1e-8, kBrightest = 1;  // of the false colours

Picture map_of(const Subject& s, const Point& p) {
  Picture out(s.grid_width, s.grid_height);
  const Range range{kDarkest, kBrightest, true};
  for (std::size_t i = 0; i < p.map.size(); ++i) {
    const float v = std::isfinite(p.map[i])
                        ? std::clamp(p.map[i], float(kDarkest), float(kBrightest))
                        : float(kBrightest);
    const auto c = false_color(place(range, v));
    std::copy(c.begin(), c.end(), &out.rgb[3 * i]);
  }
  return out;
}

std::string maps_of(const Subject& s) {
  std::string out = "<div class='maps'>";
  for (const Method& m : s.methods) {
    const Point& p = typical(s, m);
    out += "<figure>" + image(map_of(s, p), "error of " + m.name) +
           fmt::format("<figcaption>{}: {}, {}</figcaption></figure>", escaped(m.name),
                       escaped(p.setting), time_text(p.seconds));
  }
  Picture bar(256, 1);
  for (int i = 0; i < bar.width; ++i) {
    const auto c = false_color(float(i) / 255);
    std::copy(c.begin(), c.end(), bar.pixel(i, 0));
  }
  return out + "</div><figure class='bar'>" + image(bar, "scale") +
         "<figcaption><div><span>1e-8</span><span>1e-6</span><span>1e-4</span><span>0.01"
         "</span><span>1</span></div>error of the colour, |dC| / (white + "
         "|C|)</figcaption></figure>";
}

std::string subject_of(const Study& study, std::size_t k) {
  const Subject& s = study.subjects[k];
  const bool many = study.subjects.size() > 1;
  std::string out = fmt::format(
      "<h2>{}</h2><p class='soft'>{} pixels: an even grid of {} x {}, and those where "
      "some "
      "method is farthest off. Held against {}. Its own error: {}.</p>",
      s.whole && many ? "The whole scene"
      : many          ? escaped(s.name) + " alone, in the scene's light"
                      : escaped(s.name),
      s.rays, s.grid_width, s.grid_height, escaped(s.reference),
      number_text(s.reference_error));
  for (const std::string& note : s.notes)
    out += "<p class='soft'>" + escaped(note) + "</p>";
  out += fmt::format("<div class='chart' data-subject='{}'>{}</div>", k,
                     chart_svg(study, s));
  out += table_of(study, s);
  return out + maps_of(s);
}

// Notes "stage: why"; what is said of several in a row is said once: "a, b: why".
std::vector<std::string> together(const std::vector<std::string>& notes) {
  std::vector<std::string> out;
  std::string last;
  for (const std::string& note : notes) {
    const std::size_t colon = std::min(note.find(": "), note.size());
    const std::string why = note.substr(colon);
    if (!why.empty() && why == last)
      out.back().insert(out.back().size() - why.size(), ", " + note.substr(0, colon));
    else
      out.push_back(note);
    last = why;
  }
  return out;
}

}  // namespace

std::string page(const Study& study, const std::string& json, const std::string& command,
                 const Uplot& uplot) {
  std::string out =
      "<!doctype html>\n<html lang='en'><head><meta charset='utf-8'><meta "
      "name='viewport' content='width=device-width'><title>brume study: " +
      escaped(study.in) + "</title>\n<style>" + uplot.style + kPageStyle +
      "</style></head>\n<body><h1>Error against run time</h1>";
  out += fmt::format(
      "<p><code>{}</code></p><p class='soft'>{} x {} pixels of {}; scene {}; tolerance "
      "{:g}. "
      "brume {}, {}, {} cores, {}, {}. Times are of one core, medians of {} repeats in "
      "turns, the noise half the distance of the quartiles; reading and writing files is "
      "not in them. The study took {}.</p>",
      escaped(command), study.width, study.height, escaped(study.in),
      escaped(study.scene), study.tolerance, study.version, escaped(study.machine),
      study.cores, study.isa, study.date, study.repeats, time_text(study.seconds));
  for (const std::string& note : together(study.notes))
    out += "<p class='soft'>" + escaped(note) + "</p>";
  if (study.after.width > 0 && study.before.width == study.after.width)
    out += "<div class='slider'>" + image(study.before, "before") +
           image(study.after, "after") +
           "<input type='range' min='0' max='100' value='50' aria-label='before and "
           "after'></div><p class='soft'>Before and after: move the line.</p>";
  for (std::size_t k = 0; k < study.subjects.size(); ++k) out += subject_of(study, k);
  out +=
      "<h2>How to read it</h2><p>Left is fast, down is right. A method is a line from "
      "its "
      "coarsest setting to its finest; bars along time are the quartiles of its repeats. "
      "Bold rows of a table are those that no other beats in both time and error. The "
      "error counts as the scene's tolerance does: the largest of red, green and blue, "
      "relative to white and the colour itself.</p>";
  if (!uplot.script.empty())
    out +=
        "<footer><p>Charts: uPlot.</p><pre>" + escaped(uplot.licence) + "</pre></footer>";
  out +=
      "\n<script type='application/json' id='study'>" + in_script(json) + "</script>\n";
  if (!uplot.script.empty()) out += "<script>" + in_script(uplot.script) + "</script>\n";
  return out + "<script>" + in_script(kPageScript) + "</script></body></html>\n";
}

}  // namespace brume::study
