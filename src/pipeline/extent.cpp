#include "pipeline/extent.h"

#include <algorithm>
#include <cmath>

namespace brume {
namespace {

// Pixel coordinates of the corners of its local cube, which holds box and ellipsoid: the
// picture of a convex body lies within that of any points that it lies between.
std::optional<Window> window_of(const brume_medium& m, const View& view) {
  if (m.shape != BRUME_BOX && m.shape != BRUME_ELLIPSOID) return {};
  if (view.projection == Projection::latlong) return {};
  const double* l = m.local_from_world;
  glm::dmat3 local_from_world;
  glm::dvec3 origin;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) local_from_world[c][r] = l[4 * r + c];
    origin[r] = l[4 * r + 3];
  }
  const glm::dmat3 world_from_local = glm::inverse(local_from_world);
  const glm::dvec3 center = world_from_local * -origin - view.eye;
  const bool perspective = view.projection == Projection::perspective;
  // perspective: x = Z (corner + px across + py down); orthographic: x = corner + px
  // across + py down + Z forward.
  const glm::dmat3 from_pixel = perspective
                                    ? glm::dmat3(view.across, view.down, view.corner)
                                    : glm::dmat3(view.across, view.down, view.forward);
  const glm::dmat3 to_pixel = glm::inverse(from_pixel);
  double lo[2] = {1e300, 1e300}, hi[2] = {-1e300, -1e300};
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 x =
        center + world_from_local * glm::dvec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1,
                                               corner & 4 ? 1 : -1);
    const glm::dvec3 p = to_pixel * (perspective ? x : x - view.corner);
    // Beside or behind the eye there is no picture of it.
    if (perspective && !(p.z > 1e-6 * glm::length(x))) return {};
    for (int k = 0; k < 2; ++k) {
      const double at = perspective ? p[k] / p.z : p[k];
      if (!std::isfinite(at)) return {};
      lo[k] = std::min(lo[k], at);
      hi[k] = std::max(hi[k], at);
    }
  }
  // Rays go through the middles of pixels; one more on either side for rounding.
  const auto whole = [](double x) { return int(std::clamp(x, -1e8, 1e8)); };
  const int x = whole(std::floor(lo[0] - 1.5)), y = whole(std::floor(lo[1] - 1.5));
  return Window{x, y, whole(std::ceil(hi[0] + 1.5)) - x,
                whole(std::ceil(hi[1] + 1.5)) - y};
}

}  // namespace

Extent::Extent(const Window& picture)
    : picture_(picture), rows_(std::size_t(std::max(picture.height, 0))) {}

std::optional<Window> Extent::add(const brume_medium& m, const View& view) {
  const auto found = window_of(m, view);
  if (!found) {
    everywhere_ = true;
    return {};
  }
  const Window w = intersect(*found, picture_);
  for (int y = w.y; y < w.bottom() && w.width > 0; ++y) {
    Columns& row = rows_[std::size_t(y - picture_.y)];
    if (row.first >= row.end)
      row = {w.x, w.right()};
    else
      row = {std::min(row.first, w.x), std::max(row.end, w.right())};
  }
  return w;
}

Extent::Columns Extent::row(int y, int x0, int x1) const {
  if (everywhere_ || y < picture_.y || y >= picture_.bottom() || x0 < picture_.x ||
      x1 > picture_.right())
    return {x0, x1};
  const Columns& r = rows_[std::size_t(y - picture_.y)];
  const int first = std::clamp(r.first, x0, x1);
  return {first, std::clamp(r.end, first, x1)};
}

Window Extent::bounds() const {
  if (everywhere_) return picture_;
  Window all;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const Columns& r = rows_[i];
    if (r.first >= r.end) continue;
    const Window w{r.first, picture_.y + int(i), r.end - r.first, 1};
    all = all.empty() ? w : unite(all, w);
  }
  return all.empty() ? Window{picture_.x, picture_.y, 1, 1} : all;
}

}  // namespace brume
