#pragma once
// Normals of what a camera sees, from where its pixels lie.
//
//   w = 1/t   inverse distance along the ray [1/m], 0 for background: linear along a
//   plane
//             but for the bend of the picture, so that its second difference tells an
//             edge
//   x         position relative to the eye [m]
//   a b c d   differences of w over five pixels in a row: -2 -1, -1 0, 0 1, 1 2
//
// A tangent is a derivative of x over the pixels of a row, or of a column, by three of
// them (second order) on the side where w bends least: essentially non-oscillatory,
// Harten et al. 1987. Any such combination of points of a plane lies in the plane,
// whatever the projection. README, "Normals".

#include "num/math.h"

namespace relight::inline BRUME_ISA_NS {

using namespace brume;
using brume::abs, brume::sqrt;  // before those of C

/// A bend of this part of the slope, or more, is an edge.
inline constexpr float kEdge = 0.5f;
/// Slopes below this count as this much: what faces the eye bends, too.
inline constexpr float kFlat = 0.005f;
/// Two pixels whose w differ by more than this are two things.
inline constexpr float kJump = 0.05f;
/// The middle is left for a side that bends four times less: it is quieter by as much.
inline constexpr float kPreference = 0.25f;
inline constexpr float kRound = 2e-6f;  ///< rounding of a second difference

template <class T>
BRUME_INLINE T dot3(const T a[3], const T b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// A pixel and its neighbours at -2, -1, 1, 2 along a row or a column: their t and w, and
/// their positions less that of the pixel, over its distance (so that nothing leaves the
/// floats).
template <class T>
struct Line {
  T t[5], w[5];
  T q[5][3];
};

/// Direction of the surface along the line, of no particular length; `known` false where
/// no neighbour is on the same thing.
template <class T>
struct Tangent {
  T v[3];
  Mask_t<T> known;
};

template <class T>
BRUME_INLINE Tangent<T> tangent(const Line<T>& line) {
  const T zero(0.f), huge(3e38f), least(kFlat);
  const auto differ = [&](int i, int j) {
    return (line.w[i] > zero) & (line.w[j] > zero) & (line.t[i] != line.t[j]);
  };
  // Equal distances are no evidence: a covered pixel without depth has its neighbour's.
  const auto has_a = differ(0, 1), has_b = differ(1, 2), has_c = differ(2, 3),
             has_d = differ(3, 4);
  const T a = line.w[1] - line.w[0], b = line.w[2] - line.w[1], c = line.w[3] - line.w[2],
          d = line.w[4] - line.w[3];
  const auto smooth = [&](T p, T q) {
    return abs(q - p) < T(kEdge) * (abs(p) + abs(q) + least);
  };

  // Three pixels in a row where they are on one thing.
  const auto left = has_a & has_b & smooth(a, b), right = has_c & has_d & smooth(c, d);
  // A pixel between two others' depths that are flat on both sides is a filtered edge.
  const auto inside = (line.w[0] > zero) & (line.w[4] > zero);
  const auto filtered = (abs(b) > T(2.f) * abs(a) + least) &
                        (abs(c) > T(2.f) * abs(d) + least) & inside & !(left | right);
  const auto middle = has_b & has_c & smooth(b, c) & !filtered;
  const T cost_left = select(left, abs(b - a), huge),
          cost_right = select(right, abs(d - c), huge),
          cost_middle = select(middle, T(kPreference) * abs(c - b) - T(kRound), huge);
  const T best = min(cost_middle, min(cost_left, cost_right));

  // Else two: the pixel and its nearest neighbour, else the nearest pair beside it.
  const T limit(kJump);
  const auto pair = [&](Mask_t<T> has, T step) {
    return select(has & (abs(step) < limit), abs(step), huge);
  };
  const T pair_a = pair(has_a, a), pair_b = pair(has_b & !filtered, b),
          pair_c = pair(has_c & !filtered, c), pair_d = pair(has_d, d);
  const T with = min(pair_b, pair_c),
          nearest = select(with < huge, with, min(pair_a, pair_d));

  Tangent<T> out;
  out.known = (best < huge) | (nearest < huge);
  for (int k = 0; k < 3; ++k) {
    const T two = select(pair_b == nearest, -line.q[1][k],
                         select(pair_c == nearest, line.q[3][k],
                                select(pair_a == nearest, line.q[1][k] - line.q[0][k],
                                       line.q[4][k] - line.q[3][k])));
    const T three = select(cost_middle == best, line.q[3][k] - line.q[1][k],
                           select(cost_left == best, line.q[0][k] - T(4.f) * line.q[1][k],
                                  T(4.f) * line.q[3][k] - line.q[4][k]));
    out.v[k] = select(best < huge, three, two);
  }
  return out;
}

/// v / |v|; `otherwise` where v has no length.
template <class T>
BRUME_INLINE void normalise(T v[3], const T otherwise[3]) {
  const T length = sqrt(dot3(v, v));
  const auto some = (length > T(1e-18f)) & (length < T(1e18f));
  const T inverse = T(1.f) / select(some, length, T(1.f));
  for (int k = 0; k < 3; ++k) v[k] = select(some, v[k] * inverse, otherwise[k]);
}

/// Unit normal, facing the eye, of a pixel seen along `d`. Where one tangent is unknown:
/// the normal nearest to the eye's direction; where both are: that direction.
template <class T>
BRUME_INLINE void normal_of(const Line<T>& row, const Line<T>& column, const T d[3],
                            T n[3]) {
  const Tangent<T> u = tangent(row), v = tangent(column);
  const T to_eye[3] = {-d[0], -d[1], -d[2]}, zero[3] = {0.f, 0.f, 0.f};
  const T cross[3] = {u.v[1] * v.v[2] - u.v[2] * v.v[1],
                      u.v[2] * v.v[0] - u.v[0] * v.v[2],
                      u.v[0] * v.v[1] - u.v[1] * v.v[0]};
  T only[3];
  for (int k = 0; k < 3; ++k)
    only[k] = select(u.known, u.v[k], select(v.known, v.v[k], T(0.f)));
  normalise(only, zero);
  const T along = dot3(only, to_eye);
  const auto both = u.known & v.known;
  for (int k = 0; k < 3; ++k) n[k] = select(both, cross[k], to_eye[k] - along * only[k]);
  normalise(n, to_eye);
  const auto away = dot3(n, d) > T(0.f);
  for (int k = 0; k < 3; ++k) n[k] = select(away, -n[k], n[k]);
}

}  // namespace relight::inline BRUME_ISA_NS
