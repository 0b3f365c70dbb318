#include "truth/march.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "num/quadrature.h"

namespace brume::truth {
namespace {

constexpr double kDeep = 8;     // optical depth of a piece
constexpr double kBlack = 200;  // e^-200 times any light is none

// The polynomial through f at the nodes is Sum_n (2n + 1)/2 Sum_j w_j P_n(x_j) f_j
// P_n(x), and Int_-1^x P_n = (P_{n+1} - P_{n-1})(x)/(2n + 1)  (Abramowitz &
// Stegun 22.7.10).
Nodes make_nodes() {
  const auto rule = gauss_legendre<kNodes>();
  long double P[kNodes][kNodes + 1];
  for (int k = 0; k < kNodes; ++k) {
    const long double x = rule.x[k];
    P[k][0] = 1, P[k][1] = x;
    for (int n = 1; n < kNodes; ++n)
      P[k][n + 1] = ((2 * n + 1) * x * P[k][n] - n * P[k][n - 1]) / (n + 1);
  }
  Nodes nodes;
  for (int k = 0; k < kNodes; ++k) {
    nodes.x[k] = double(rule.x[k]);
    nodes.w[k] = double(rule.w[k]);
    for (int j = 0; j < kNodes; ++j) {
      long double sum = rule.x[k] + 1;
      for (int n = 1; n < kNodes; ++n) sum += P[j][n] * (P[k][n + 1] - P[k][n - 1]);
      nodes.up_to[k][j] = double(rule.w[j] * sum / 2);
    }
  }
  return nodes;
}

// So narrow that there is hardly a number between its ends.
bool tiny(double a, double b) {
  return b - a <= 8 * std::numeric_limits<double>::epsilon() *
                      std::max(std::abs(a), std::abs(b)) ||
         b - a < 1e-300;
}

}  // namespace

const Nodes& nodes() {
  static const Nodes made = make_nodes();
  return made;
}

template <int N>
auto March<N>::look(const AlongRay<N>& f, double a, double b) -> Piece {
  const Nodes& rule = nodes();
  const double half = (b - a) / 2;
  double sigma[N][kNodes], e[N][kNodes];
  for (int k = 0; k < kNodes; ++k) {
    const Local<N> at = f(node(a, b, k));
    for (int c = 0; c < N; ++c)
      sigma[c][k] = at.sigma[std::size_t(c)], e[c][k] = at.e[std::size_t(c)];
  }
  cost_.so_far += kNodes;
  Piece p{a, b, {}, {}};
  for (int c = 0; c < N; ++c) {
    double depth_all = 0, light = 0, e_mean = 0, sigma_mean = 0;
    for (int k = 0; k < kNodes; ++k) {
      depth_all += half * rule.w[k] * sigma[c][k];
      sigma_mean += rule.w[k] * sigma[c][k];
      e_mean += rule.w[k] * e[c][k];
      if (e[c][k] == 0) continue;
      double depth = 0;
      for (int j = 0; j < kNodes; ++j) depth += rule.up_to[k][j] * sigma[c][j];
      light += half * rule.w[k] * e[c][k] * std::exp(-std::max(half * depth, 0.));
    }
    if (std::isnan(depth_all)) depth_all = std::numeric_limits<double>::infinity();
    // A wall: it cannot be cut finer, so its light is that of its mean source.
    if (depth_all > kDeep && tiny(a, b))
      light = e_mean / sigma_mean * -std::expm1(-depth_all);
    p.tau[std::size_t(c)] = depth_all;
    p.L[std::size_t(c)] = light;
  }
  return p;
}

template <int N>
bool March<N>::accepted(const Piece& whole, const Piece& near, const Piece& far) {
  Lanes tau_change, L_change;
  bool good = true;
  for (std::size_t c = 0; c < N; ++c) {
    tau_change[c] = L_change[c] = 0;
    if (tau[c] > kBlack) continue;
    const double both = near.L[c] + std::exp(-near.tau[c]) * far.L[c];
    const double T = std::exp(-tau[c]);
    tau_change[c] = std::abs(near.tau[c] + far.tau[c] - whole.tau[c]);
    L_change[c] = T * std::abs(both - whole.L[c]);
    good = good && whole.tau[c] <= kDeep && tau_change[c] <= tolerance_ &&
           L_change[c] <= tolerance_ * (white_ + std::abs(L[c] + T * both));
  }
  if (!good && !tiny(whole.a, whole.b)) return false;
  for (std::size_t c = 0; c < N; ++c) {
    tau_error[c] += tau_change[c];
    L_error[c] += L_change[c];
  }
  return true;
}

template <int N>
void March<N>::take(const Piece& p) {
  if (last) return;
  if (tau[0] + p.tau[0] >= until) {
    last = p;
    return;
  }
  if (taken) taken->push_back({p.a, p.b, tau, p.tau});
  for (std::size_t c = 0; c < N; ++c) {
    if (tau[c] <= kBlack) L[c] += std::exp(-tau[c]) * p.L[c];
    tau[c] += p.tau[c];
  }
}

template <int N>
double March<N>::through() const {
  return std::exp(-*std::ranges::min_element(tau));
}

template <int N>
bool March<N>::done() const {
  return stopped || last || *std::ranges::min_element(tau) > kBlack;
}

template <int N>
void March<N>::over(const AlongRay<N>& f, double a, double b) {
  stack_ = {look(f, a, b)};
  while (!stack_.empty() && !done()) {
    if (nested_ ? cost_.spent() : cost_.twice_spent()) {
      stopped = true;
      converged = false;
      return;
    }
    const Piece whole = stack_.back();
    stack_.pop_back();
    const double mid = whole.a + (whole.b - whole.a) / 2;
    const Piece near = look(f, whole.a, mid), far = look(f, mid, whole.b);
    if (accepted(whole, near, far)) {
      take(near);
      take(far);
    } else {
      stack_.push_back(far);
      stack_.push_back(near);
    }
  }
}

template class March<1>;
template class March<3>;
template class March<kSpectral>;

}  // namespace brume::truth
