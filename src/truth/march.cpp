#include "truth/march.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "num/quadrature.h"

namespace brume::truth {
namespace {

constexpr int kNodes = 12;
constexpr double kDeep = 8;         // optical depth of a piece
constexpr double kBlack = 200;      // e^-200 times any light is none
constexpr int kMostPieces = 40000;  // of a ray

/// Nodes, weights, and `up_to[k][j]`: what node j adds to the integral from -1 to node k.
struct Nodes {
  double x[kNodes], w[kNodes], up_to[kNodes][kNodes];
};

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

auto March::look(const AlongRay& f, double a, double b) -> Piece {
  static const Nodes nodes = make_nodes();
  const double half = (b - a) / 2;
  Local at[kNodes];
  for (int k = 0; k < kNodes; ++k) at[k] = f(a + half * (1 + nodes.x[k]));
  evaluations += kNodes;
  Piece p{a, b, {}, {}};
  for (int c = 0; c < 3; ++c) {
    for (int k = 0; k < kNodes; ++k) {
      p.tau[c] += half * nodes.w[k] * at[k].sigma[c];
      if (at[k].e[c] == 0) continue;
      double depth = 0;
      for (int j = 0; j < kNodes; ++j) depth += nodes.up_to[k][j] * at[j].sigma[c];
      p.L[c] += half * nodes.w[k] * at[k].e[c] * std::exp(-std::max(half * depth, 0.));
    }
    if (std::isnan(p.tau[c])) p.tau[c] = std::numeric_limits<double>::infinity();
    if (p.tau[c] <= kDeep || !tiny(a, b)) continue;
    // A wall: it cannot be cut finer, so its light is that of its mean source.
    double e = 0, sigma = 0;
    for (int k = 0; k < kNodes; ++k)
      e += nodes.w[k] * at[k].e[c], sigma += nodes.w[k] * at[k].sigma[c];
    p.L[c] = e / sigma * -std::expm1(-p.tau[c]);
  }
  return p;
}

bool March::accepted(const Piece& whole, const Piece& near, const Piece& far) {
  Rgb tau_change, L_change;
  bool good = true;
  for (int c = 0; c < 3; ++c) {
    tau_change[c] = L_change[c] = 0;
    if (tau[c] > kBlack) continue;
    const double both = near.L[c] + std::exp(-near.tau[c]) * far.L[c];
    const double T = std::exp(-tau[c]);
    tau_change[c] = std::abs(near.tau[c] + far.tau[c] - whole.tau[c]);
    L_change[c] = T * std::abs(both - whole.L[c]);
    good = good && whole.tau[c] <= kDeep && tau_change[c] <= tolerance_ &&
           L_change[c] <= tolerance_ * (white_ + std::abs(L[c] + T * both));
  }
  if (!good && pieces_ < kMostPieces && !tiny(whole.a, whole.b)) return false;
  converged = converged && (good || pieces_ < kMostPieces);
  for (int c = 0; c < 3; ++c) {
    tau_error[c] += tau_change[c];
    L_error[c] += L_change[c];
  }
  return true;
}

void March::take(const Piece& p) {
  for (int c = 0; c < 3; ++c) {
    if (tau[c] <= kBlack) L[c] += std::exp(-tau[c]) * p.L[c];
    tau[c] += p.tau[c];
  }
}

bool March::opaque() const { return std::min({tau[0], tau[1], tau[2]}) > kBlack; }

void March::over(const AlongRay& f, double a, double b) {
  stack_ = {look(f, a, b)};
  while (!stack_.empty() && !opaque()) {
    const Piece whole = stack_.back();
    stack_.pop_back();
    ++pieces_;
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

}  // namespace brume::truth
