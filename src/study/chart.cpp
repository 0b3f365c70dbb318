#include "study/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "study/report.h"

namespace brume::study {

namespace {

constexpr int kWidth = 860, kHeight = 460, kLeft = 74, kRight = 20, kTop = 12, kRow = 22,
              kBottom = 58;
constexpr double kSmallest = 1e-9;  // errors below are drawn here

// One logarithmic axis, whole decades from end to end.
struct Axis {
  double low = 0, high = 1;  // exponents of ten
  double from = 0, to = 1;   // pixels

  double at(double value) const {
    return from + (std::log10(value) - low) / (high - low) * (to - from);
  }
};

double shown_error(const Point& p) { return std::max(p.color.max, kSmallest); }

Axis axis_over(double least, double most, double from, double to) {
  Axis a{std::floor(std::log10(least)), std::ceil(std::log10(most)), from, to};
  if (a.high - a.low < 1) a.high = a.low + 1;
  return a;
}

std::string decade(int exponent, bool time) {
  if (time) return time_text(std::pow(10., exponent));
  return fmt::format("1e{}", exponent);
}

std::string mark(MethodKind kind, double x, double y) {
  switch (kind) {
    case MethodKind::ours:
      return fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='5'/>", x, y);
    case MethodKind::source:
      return fmt::format("<path d='M{:.1f} {:.1f}l6 6 -6 6 -6 -6z'/>", x, y - 6);
    case MethodKind::marching:
      return fmt::format("<rect x='{:.1f}' y='{:.1f}' width='8' height='8'/>", x - 4,
                         y - 4);
    default:
      return fmt::format("<path d='M{:.1f} {:.1f}l6 10h-12z'/>", x, y - 6);
  }
}

// Names and marks of the methods in rows above the plot, where no point can lie.
struct Legend {
  std::string drawn;
  int height = 0;
};
Legend legend_of(const Subject& s) {
  constexpr double kLetter = 7.2, kMark = 20, kGap = 24;  // of a letter: about
  Legend l;
  double x = kLeft;
  int row = 0;
  for (const Method& m : s.methods) {
    const double wide = kMark + kLetter * double(m.name.size());
    if (x > kLeft && x + wide > kWidth - kRight) x = kLeft, ++row;
    const double y = kTop + kRow * (row + 0.5);
    l.drawn += fmt::format(
        "<g fill='{}'>{}</g><text x='{:.1f}' y='{:.1f}' fill='#333'>{}</text>",
        color_of(m.kind), mark(m.kind, x + 6, y - 1), x + kMark, y + 3, escaped(m.name));
    x += wide + kGap;
  }
  l.height = kRow * (row + 1);
  return l;
}

std::string line_of(const Study& study, const Method& m, const Axis& x, const Axis& y) {
  std::string out = fmt::format("<g fill='{0}' stroke='{0}'>", color_of(m.kind));
  std::vector<const Point*> points;
  for (const Point& p : m.points) points.push_back(&p);
  // In the order of their settings: a curve is a walk along the knob.
  std::string path;
  for (const Point* p : points)
    path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", x.at(p->seconds),
                        y.at(shown_error(*p)));
  if (points.size() > 1)
    out += fmt::format("<path d='{}' fill='none' stroke-width='2' opacity='.8'/>", path);
  const double pixels = double(study.width) * study.height;
  for (const Point* p : points) {
    const double h = y.at(shown_error(*p));
    const double low = p->frame + pixels * p->per_pixel.low,
                 high = p->frame + pixels * p->per_pixel.high;
    if (low > 0)
      out += fmt::format("<path d='M{:.1f} {:.1f}H{:.1f}' stroke-width='1.5'/>",
                         x.at(low), h, x.at(high));
    out += fmt::format(
        "<g>{}<title>{}: {}\n{} for the frame, {} a pixel\nworst error {}</title></g>",
        mark(m.kind, x.at(p->seconds), h), escaped(m.name), escaped(p->setting),
        time_text(p->seconds), time_text(p->per_pixel.median), number_text(p->color.max));
  }
  return out + "</g>";
}

}  // namespace

const char* color_of(MethodKind k) {
  // Okabe & Ito 2008: told apart by all kinds of eyes.
  constexpr const char* kColors[] = {"#0072b2", "#d55e00", "#888888", "#009e73"};
  return kColors[int(k)];
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '\'')
      out += "&#39;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

std::string chart_svg(const Study& study, const Subject& s) {
  double least_x = 1e300, most_x = 0, least_y = 1e300, most_y = 0;
  for (const Method& m : s.methods)
    for (const Point& p : m.points) {
      if (!std::isfinite(p.color.max) || !(p.seconds > 0)) continue;
      least_x = std::min(least_x, p.seconds), most_x = std::max(most_x, p.seconds);
      least_y = std::min(least_y, shown_error(p));
      most_y = std::max(most_y, shown_error(p));
    }
  if (most_x == 0) return {};
  const Axis x = axis_over(least_x, most_x, kLeft, kWidth - kRight);
  const Legend legend = legend_of(s);
  const int top = kTop + legend.height;
  const Axis y = axis_over(least_y, most_y, kHeight - kBottom, top);

  std::string out = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {0} {1}' width='{0}' "
      "height='{1}' font-family='system-ui,sans-serif' font-size='13' role='img'>"
      "<title>{2}: error against time</title><rect width='{0}' height='{1}' "
      "fill='#fff'/>",
      kWidth, kHeight, escaped(s.name));
  out += "<g stroke='#ddd' fill='#333'>";
  for (int e = int(x.low); e <= int(x.high); ++e) {
    const double at = x.at(std::pow(10., e));
    out += fmt::format(
        "<path d='M{0:.1f} {1}V{2}'/><text x='{0:.1f}' y='{3}' stroke='none' "
        "text-anchor='middle'>{4}</text>",
        at, top, kHeight - kBottom, kHeight - kBottom + 18, decade(e, true));
  }
  for (int e = int(y.low); e <= int(y.high); ++e) {
    const double at = y.at(std::pow(10., e));
    out += fmt::format(
        "<path d='M{0} {1:.1f}H{2}'/><text x='{3}' y='{4:.1f}' stroke='none' "
        "text-anchor='end'>{5}</text>",
        kLeft, at, kWidth - kRight, kLeft - 8, at + 4, decade(e, false));
  }
  out += "</g>";
  out += fmt::format(
      "<g fill='#333'><text x='{}' y='{}' text-anchor='middle'>time for the {} x {} "
      "frame, one core</text><text transform='translate(16 {}) rotate(-90)' "
      "text-anchor='middle'>worst error of a colour, |dC| / ({:g} + |C|)</text></g>",
      (kLeft + kWidth - kRight) / 2, kHeight - 8, study.width, study.height,
      (top + kHeight - kBottom) / 2, study.white);
  // A line ends where its errors do: what is not finite has no place.
  for (const Method& m : s.methods) {
    Method drawn = m;
    std::erase_if(drawn.points, [](const Point& p) {
      return !std::isfinite(p.color.max) || !(p.seconds > 0);
    });
    out += line_of(study, drawn, x, y);
  }
  return out + legend.drawn + "</svg>\n";
}

}  // namespace brume::study
