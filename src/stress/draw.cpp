#include "stress/draw.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace brume::stress {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

// One component.
double number(const ParamSpec& spec, double standard, double most, Random& r) {
  const double lo = std::max(spec.minimum, -most), hi = std::min(spec.maximum, most);
  const auto inside = [&](double x) { return std::clamp(x, lo, hi); };
  const double sign = lo < 0 && (hi <= 0 || r.uniform() < 0.5) ? -1 : 1;
  const double reach = std::max(sign < 0 ? -lo : hi, 1e-12);
  const double dice = r.uniform();
  if (dice < 0.30) return inside(standard);
  if (dice < 0.36) return lo;
  if (dice < 0.44) return hi;
  if (dice < 0.50) return inside(0);
  if (dice < 0.55) return inside(sign * reach * log_uniform(r, 1e-30, 1e-12));
  if (dice < 0.58 && spec.infinite && spec.maximum == kInf) return kInf;
  if (dice < 0.85) return inside(sign * reach * log_uniform(r, 1e-12, 1));
  return inside(r.uniform(lo, hi));
}

// A vector of metres that may point anywhere is a place, one without unit a direction.
bool is_place(const ParamSpec& spec) { return spec.unit == "m" && spec.minimum < 0; }

void append(std::vector<double>& to, const ParamSpec& spec, const glm::dvec3& v) {
  for (int i = 0; i < 3; ++i) to.push_back(std::clamp(v[i], spec.minimum, spec.maximum));
}

}  // namespace

Value Draw::value(const ParamSpec& spec) {
  Random& r = random_;
  const Value standard = default_value(spec);
  Value v = standard;
  switch (spec.kind) {
    case Kind::number:
      for (double& x : v.numbers) x = number(spec, x, 1e7, r);
      break;
    case Kind::vec3:
      if (is_place(spec) && integer(r, 4)) {
        v.numbers.clear();
        append(v.numbers, spec, place_ = near_eye());
      } else if (spec.unit.empty() && spec.minimum < 0 && integer(r, 4)) {
        // To the eye, from it, anywhere.
        const glm::dvec3 to_eye = frame_.eye - place_;
        const int way = glm::length(to_eye) > 0 ? integer(r, 3) : 0;
        v.numbers.clear();
        append(v.numbers, spec,
               way == 0 ? draw_direction(r, frame_.up)
                        : (way == 1 ? to_eye : -to_eye) / glm::length(to_eye));
      } else {
        for (double& x : v.numbers) x = number(spec, x, 1e7, r);
        place_ = {v.numbers[0], v.numbers[1], v.numbers[2]};
      }
      break;
    case Kind::numbers:
      if (is_place(spec)) {  // some, one not far from the other
        const int dice = integer(r, 16), count = dice < 6 ? 0 : dice < 12 ? 1 : dice - 10;
        const double step = log_uniform(r, 1e-2, 1e4);
        place_ = near_eye();
        v.numbers.clear();
        for (int k = 0; k < count; ++k) {
          append(v.numbers, spec, place_);
          place_ += step * r.uniform() * draw_direction(r, frame_.up);
        }
        if (count > 0 && integer(r, 64) == 0) v.numbers.pop_back();  // no longer triples
      } else {
        for (double& x : v.numbers) x = number(spec, x, 1e7, r);
      }
      break;
    case Kind::integer:
      for (double& x : v.numbers) {
        x = std::round(number(spec, x, 1e7, r));
        x = std::clamp(x, std::ceil(spec.minimum), std::floor(spec.maximum));
      }
      break;
    case Kind::rgb: {
      const bool word = !spec.words.empty() && r.uniform() < 0.1;
      if (word) {
        v.numbers.clear();
        v.text = spec.words[std::size_t(integer(r, int(spec.words.size())))];
        break;
      }
      v.text.clear();
      v.numbers.resize(3);
      const bool grey = r.uniform() < 0.5;
      for (std::size_t c = 0; c < 3; ++c) {
        const double base = standard.numbers.size() == 3 ? standard.numbers[c] : 0;
        v.numbers[c] = grey && c > 0 ? v.numbers[0] : number(spec, base, 1e9, r);
      }
      break;
    }
    case Kind::flag:
      v.numbers = {double(integer(r, 2))};
      break;
    case Kind::choice:
      if (!spec.words.empty())
        v.text = spec.words[std::size_t(integer(r, int(spec.words.size())))];
      break;
    case Kind::matrix:
    case Kind::text:
    case Kind::texts:
      break;  // no range says what makes sense here
  }
  return v;
}

glm::dvec3 Draw::near_eye() {
  return frame_.eye +
         log_uniform(random_, 1e-3, 1e5) * draw_direction(random_, frame_.up);
}

namespace {

// Pixels of any projection for a frame that has a camera, twice as wide as high at most.
View draw_view(Random& r, const FrameInfo& f) {
  View v;
  v.projection = Projection(integer(r, 3));
  v.eye = f.eye, v.forward = f.forward, v.right = f.camera_right, v.up = f.camera_up;
  v.display = f.display;
  const double w = f.display.width, h = f.display.height;
  if (v.projection == Projection::latlong) {
    v.corner = {-0.5, 0.25, 0};
    v.across = {1 / w, 0, 0};
    v.down = {0, -0.5 / h, 0};
    return v;
  }
  const bool fan = v.projection == Projection::perspective;
  const double width = f.pixel_footprint * (fan ? 1 : log_uniform(r, 1, 1e6));
  v.across = width * log_uniform(r, 0.7, 1.4) * v.right;
  v.down = -width * v.up;
  v.corner = -0.5 * w * v.across - 0.5 * h * v.down;
  if (fan) v.corner += v.forward;
  return v;
}

}  // namespace

FrameInfo draw_frame(Random& r) {
  FrameInfo f;
  f.has_camera = true;
  f.display = {0, 0, 1920, 1080};
  f.pixel_footprint = 1e-3;
  const int place = integer(r, 8);
  const double side = r.uniform() < 0.5 ? -1 : 1;
  if (place == 0) f.eye = {side * 1e7, -side * 1e7, side * 1e7};
  if (place == 1) f.eye = {0, 0, 6.4e6};
  if (place == 2) f.eye = {r.uniform(-1e7, 1e7), r.uniform(-1e7, 1e7), side * 6.4e6};
  if (place == 3) f.eye = {6.4e6, 3, side * log_uniform(r, 1e-3, 1e4)};
  if (place >= 4 && place < 7) f.eye.z = side * log_uniform(r, 1e-6, 1e7);
  if (integer(r, 4) == 0) {
    f.up = draw_direction(r, {0, 0, 1});
    f.eye = {f.eye.z * f.up.x, f.eye.z * f.up.y, f.eye.z * f.up.z};
  }
  FrameInfo::Sun sun;
  sun.to = draw_direction(r, f.up);
  if (glm::dot(sun.to, f.up) < 0 && integer(r, 4)) sun.to = -sun.to;
  f.sun = sun;
  // A camera that looks anywhere.
  f.forward = draw_direction(r, f.up);
  const glm::dvec3 aside =
      std::abs(f.forward.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  f.camera_right = glm::normalize(glm::cross(f.forward, aside));
  f.camera_up = glm::cross(f.camera_right, f.forward);
  if (integer(r, 2)) f.pixel_footprint = log_uniform(r, 1e-5, 3e-2);
  if (integer(r, 2)) f.look(draw_view(r, f));
  return f;
}

glm::dvec3 draw_direction(Random& r, const glm::dvec3& up) {
  glm::dvec3 v;
  double length = 0;
  do {
    v = {r.uniform(-1, 1), r.uniform(-1, 1), r.uniform(-1, 1)};
    length = glm::length(v);
  } while (length < 0.1 || length > 1);
  v /= length;
  const int kind = integer(r, 8);
  if (kind == 0) return r.uniform() < 0.5 ? up : -up;
  if (kind <= 3) {  // level, or nearly so
    glm::dvec3 level = v - glm::dot(v, up) * up;
    if (glm::length(level) < 1e-3) return v;
    level = glm::normalize(level);
    const double slope = kind == 1 ? 0 : log_uniform(r, 1e-9, 0.1);
    return glm::normalize(level + (r.uniform() < 0.5 ? slope : -slope) * up);
  }
  return v;
}

double draw_distance(Random& r) {
  const int kind = integer(r, 16);
  if (kind == 0) return 0;
  if (kind == 1) return log_uniform(r, 1e-44, 1e-38);
  if (kind == 2) return kInf;
  if (kind < 6) return log_uniform(r, 1e-30, 1e30);
  return log_uniform(r, 1e-3, 1e7);
}

}  // namespace brume::stress
