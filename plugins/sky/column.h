#pragma once
// Column densities: the integral of a constituent's density along a straight ray through
// a spherical atmosphere, in closed form. Times a coefficient [1/m] a column is an
// optical depth: what the sun's light has crossed, without a table.
//
// R planet radius [m] · h altitude [m] · r = R + h · mu cosine between ray and local
// vertical · H scale height [m] p = r sqrt(1 - mu^2) distance between the ray's line and
// the planet's centre · c = r^2 - R^2 = h (2R + h) [m^2]

#include "spectrum.h"
#include "types.h"

namespace brume::sky::inline BRUME_ISA_NS {

// Gauss's rule of three on [0, 1].
constexpr double kRoot15 = 3.872983346207417;
constexpr double kGaussNode[3] = {.5 - kRoot15 / 10, .5, .5 + kRoot15 / 10};
constexpr double kGaussWeight[3] = {5. / 18, 8. / 18, 5. / 18};

/// Altitude [m] of a point with r^2 - R^2 = c. Nothing cancels at planet scale: in float,
/// relative error 2 eps.
template <Real T>
BRUME_INLINE T altitude(T c, Same<T> R) {
  return c / (R + sqrt(R * R + c));
}

/// e^{x^2} erfc(x) for x >= 0: relative error 6.2e-8 (float 2e-7). Chebyshev fit of (1 +
/// 2x) e^{x^2} erfc x in (x - K)/(x + K), the variable of Shepherd and Laframboise 1981;
/// K = 2.5 and the coefficients are our own fit.
template <Real T>
BRUME_INLINE T erfcx_positive(T x) {
  using S = Scalar_t<T>;
  constexpr double k[] = {0.00040548891917263109, 0.00046333752059853983,
                          -0.0041802466303207161, 0.0009467596303256005,
                          0.032677570070453387,   -0.10297053835625597,
                          0.15764429480764596,    -0.099024241658084602,
                          -0.12235746577389315,   1.264838180237798};
  const T t = (x - T(S(2.5))) / (x + T(S(2.5)));
  T q(S(-6.3917866044111565e-05));
  for (double c : k) q = q * t + T(S(c));
  return q / (T(1) + x + x);
}

/// Column [m] of density e^{-(r' - r)/H} outward to infinity along a ray with mu >= 0.
///   With s = r' - r and u0 = r - p:  integral of e^{-s/H} (s + u0)^{-1/2} f(s) ds,  f =
///   r'/sqrt(r' + p),
/// f expanded to first order around s = 0, which leaves erfcx and algebra. Vertical: H.
/// Grazing: sqrt(pi r H / 2). Relative error ~ (H/r)^2: 2e-6 on earth, 1e-5 on mars,
/// whatever mu.
template <Real T>
BRUME_INLINE T exponential_column(T r, Same<T> mu, Same<T> H) {
  using S = Scalar_t<T>;
  const T sin_chi = sqrt(max(T(1) - mu * mu, T(0)));
  const T root_u0 = mu * sqrt(r / (T(1) + sin_chi)), u0 = root_u0 * root_u0;
  const T rp = r + r * sin_chi, root_H = sqrt(H);
  const T M0 = T(S(1.7724538509055160)) * root_H * erfcx_positive(root_u0 / root_H);
  const T M1 = H * root_u0 + (T(S(.5)) * H - u0) * M0;
  return r / sqrt(rp) * (M0 + (T(1) / r - T(S(.5)) / rp) * M1);
}

/// Density of ozone at altitude h, of its maximum.
template <Real T>
BRUME_INLINE T ozone_density(const Shape<Scalar_t<T>>& a, T h) {
  return max(T(1) - abs(h - T(a.O_mid)) * T(1 / a.O_half), T(0));
}

/// Column [m] of ozone outward from altitude h, t along a line from its lowest point,
/// where r^2 - R^2 = c_t. Along the line altitude is quadratic in distance up to 1e-3 of
/// itself, so Simpson's rule on each straight flank of the tent errs by less than 1e-5.
template <Real T>
BRUME_INLINE T ozone_column(const Shape<Scalar_t<T>>& a, T h, Same<T> t, Same<T> c_t) {
  using S = Scalar_t<T>;
  const T R(a.R);
  T from = max(h, T(a.O_mid - a.O_half)), sum(0);
  const S edges[] = {a.O_mid, min(a.O_mid + a.O_half, a.top)};
  T t0 = select(from > h, sqrt(max(from * (R + R + from) - c_t, T(0))), t);
  for (S edge : edges) {
    const T to = max(from, T(edge)), t1 = sqrt(max(to * (R + R + to) - c_t, T(0)));
    const T tm = T(S(.5)) * (t0 + t1);
    const T mid = ozone_density(a, altitude(c_t + tm * tm, R));
    sum = sum + (t1 - t0) * T(S(1. / 6)) *
                    (ozone_density(a, from) + T(4) * mid + ozone_density(a, to));
    from = to, t0 = t1;
  }
  return sum;
}

/// Columns [m] of the three constituents.
template <class T>
struct Columns {
  T R, M, O;
};

/// From altitude h (at most `top`) out of the air, any mu whose ray misses the ground.
template <Real T>
BRUME_INLINE Columns<T> columns_to_space(const Shape<Scalar_t<T>>& a, T h, Same<T> mu) {
  using S = Scalar_t<T>;
  const T R(a.R), r = R + h, r_mu = r * mu, up = abs(mu);
  const auto down = mu < T(0);
  const T c_t = h * (R + R + h) - r_mu * r_mu;  // lowest point of the line
  const T h_t = max(altitude(c_t, R), T(0)), r_t = R + h_t;
  const T c_top(a.top * (a.R + a.R + a.top)), r_top(a.R + a.top);
  const T mu_top = sqrt(max(c_top - c_t, T(0))) / r_top;

  auto exponential = [&](S scale) {
    const T H(scale), inv(S(-1) / scale);
    const T here = exp(h * inv) * exponential_column(r, up, H);
    const T beyond = exp(T(a.top) * inv) * exponential_column(r_top, mu_top, H);
    const T lowest = sqrt(T(S(1.5707963267948966)) * r_t * H) *
                     (T(1) + T(S(.375)) * H / r_t);  // grazing limit
    const T both = exp(h_t * inv) * (lowest + lowest) - here;
    return max(select(down, both, here) - beyond, T(0));
  };
  const T ozone = ozone_column(a, h, abs(r_mu), c_t),
          ozone_t = ozone_column(a, h_t, T(0), c_t);
  return {exponential(a.H_R), exponential(a.H_M),
          select(down, ozone_t + ozone_t - ozone, ozone)};
}

/// Over distance d along a ray from altitude h, neither end below ground nor above the
/// air. Differences of columns to infinity: absolute error 2e-7 of the column from the
/// lower end; over less than .3 of a scale height, where digits would be lost, Gauss's
/// rule of three, relative error 1e-6.
template <Real T>
BRUME_INLINE Columns<T> columns_between(const Shape<Scalar_t<T>>& a, T h, Same<T> mu,
                                        Same<T> d) {
  using S = Scalar_t<T>;
  const T R(a.R), r = R + h, b = r * mu, c = h * (R + R + h);
  const T h1 = altitude(c + d * (b + b + d), R), r1 = R + h1, mu1 = (b + d) / r1;
  const T c_t = c - b * b, h_t = altitude(c_t, R), r_t = R + h_t;
  const T begin = select(mu >= T(0), T(1), T(-1)), end = select(mu1 >= T(0), T(-1), T(1));
  const auto dips = (mu < T(0)) & (mu1 > T(0));
  const T up = abs(mu), up1 = min(abs(mu1), T(1));

  auto exponential = [&](S scale) {
    const T H(scale), inv(S(-1) / scale);
    const T lowest =
        sqrt(T(S(1.5707963267948966)) * r_t * H) * (T(1) + T(S(.375)) * H / r_t);
    const T twice = select(dips, exp(h_t * inv) * (lowest + lowest), T(0));
    return max(begin * exp(h * inv) * exponential_column(r, up, H) +
                   end * exp(h1 * inv) * exponential_column(r1, up1, H) + twice,
               T(0));
  };
  const T lowest = ozone_column(a, h_t, T(0), c_t);
  const T ozone = begin * ozone_column(a, h, abs(b), c_t) +
                  end * ozone_column(a, h1, abs(b + d), c_t) +
                  select(dips, lowest + lowest, T(0));
  Columns<T> out{exponential(a.H_R), exponential(a.H_M), max(ozone, T(0))};
  const auto brief = d < T(S(.3) * min(a.H_R, a.H_M));
  if (!any(brief)) return out;
  Columns<T> sum{T(0), T(0), T(0)};
  for (int k = 0; k < 3; ++k) {
    const T t = T(S(kGaussNode[k])) * d, z = altitude(c + t * (b + b + t), R);
    const T w = T(S(kGaussWeight[k])) * d;
    sum.R += w * exp(z * T(-1 / a.H_R));
    sum.M += w * exp(z * T(-1 / a.H_M));
    sum.O += w * ozone_density(a, z);
  }
  return {select(brief, sum.R, out.R), select(brief, sum.M, out.M),
          select(brief, sum.O, out.O)};
}

/// How light grows along a path: as the opacity of what scatters on it, ozone left out.
/// Light over this is smooth in distance and elevation, and the local source at 0.
template <Real T>
BRUME_INLINE T growth_over(const Columns<T>& c, Same<T> extinct_R, Same<T> extinct_M) {
  return transmit(extinct_R * c.R + extinct_M * c.M).A;
}

/// The sun from altitude h >= 0, its middle at zenith cosine mu: what part of its disc
/// stands above the ground, and the zenith cosine of that part's centroid, by which its
/// light is dimmed. Of a disc cut x radii below its middle (Bronstein, circular segment):
/// part (arccos(-x) + x s)/pi, s = sqrt(1 - x^2), its centroid 2 s^3/(3 pi part) above
/// the middle.
template <class T>
struct Shown {
  T part, mu;
};
template <Real T>
BRUME_INLINE Shown<T> shown_sun(const Shape<Scalar_t<T>>& a, T h, Same<T> mu) {
  using S = Scalar_t<T>;
  const T R(a.R), r = R + h, radius = R / r * T(S(kSunRadius));  // in cosines
  const T horizon = -sqrt(h * (R + r)) / r, x = (mu - horizon) / radius;
  const T cut = clamp(x, T(-1), T(1)), s = sqrt(T(1) - cut * cut);
  const T area = acos(-cut) + cut * s;
  const T up = min(T(S(2. / 3)) * s * s * s / max(area, T(S(1e-6))), T(1));
  return {select(x < T(1), area * T(S(1 / double(kPi))), T(1)), mu + up * radius};
}

/// Does the ray from altitude h with cosine mu miss the planet?
template <Real T>
BRUME_INLINE Mask_t<T> sees_space(const Shape<Scalar_t<T>>& a, T h, Same<T> mu) {
  const T R(a.R), r_mu = (R + h) * mu;
  return (mu >= T(0)) | (h * (R + R + h) > r_mu * r_mu);
}

}  // namespace brume::sky::inline BRUME_ISA_NS
