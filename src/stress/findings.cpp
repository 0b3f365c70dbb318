#include "stress/findings.h"

#include <bit>
#include <cmath>
#include <limits>

namespace brume::stress {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

struct About {
  const char *name, *meaning;
};
constexpr About kAbout[kLaws] = {
    {"finite", "numbers come out"},
    {"range", "0 <= T <= 1"},
    {"positive", "light is never negative"},
    {"energy", "no more than there is"},
    {"split", "T(a,c) = T(a,b) T(b,c)"},
    {"split_L", "L(a,c) = L(a,b) + T(a,b) L(b,c)"},
    {"monotone", "farther is never clearer"},
    {"scale", "lengths x k, densities / k"},
    {"weight", "weight w gives T^w"},
    {"lanes", "however cut, any address: same bits"},
    {"neighbours", "NaN stays where it is"},
    {"isa", "instruction sets agree"},
    {"additive", "lights add up"},
    {"dark", "no light, no change; T as without"},
    {"order", "order of stages changes no bit"},
    {"turn", "turned all together: the same"},
    {"alpha", "coverage stays"},
    {"linear", "out(aI + bJ) = a out(I) + b out(J)"},
    {"exposure", "out(kI) = k out(I)"},
    {"keeps", "no light is made"},
    {"step", "steps from ray to ray as in truth"},
    {"jump", "no jumps but the truth's"},
    {"truth_T", "T as the truth has it"},
    {"truth_L", "L as the truth has it"},
    {"truth", "as the truth has it"},
};

}  // namespace

const char* name(Law law) { return kAbout[std::size_t(law)].name; }
const char* meaning(Law law) { return kAbout[std::size_t(law)].meaning; }

void Findings::take(Law law, std::uint64_t number, int channel, double got, double wanted,
                    double allowed, double by) {
  Finding& f = of[std::size_t(law)];
  ++f.checked;
  if (std::isnan(by)) by = kInf;  // the bound itself is no number
  if (by > 1) ++f.broken;
  if (by < f.worst || (by == f.worst && f.checked > 1 && number >= f.worst_case)) return;
  f.worst = by;
  f.worst_case = number;
  f.channel = channel;
  f.got = got, f.wanted = wanted, f.allowed = allowed;
}

void Findings::near(Law law, std::uint64_t number, int channel, double got, double wanted,
                    double allowed) {
  if (allowed == kInf && std::isfinite(got)) return;  // rounding explains everything
  const double off = got == wanted ? 0 : std::abs(got - wanted);
  take(law, number, channel, got, wanted, allowed,
       std::isnan(off) ? kInf
       : off == 0      ? 0
                       : off / allowed);
}

void Findings::at_most(Law law, std::uint64_t number, int channel, double got,
                       double wanted, double allowed) {
  if (allowed == kInf && std::isfinite(got)) return;
  const double off = got - wanted;
  take(law, number, channel, got, wanted, allowed,
       std::isnan(off) ? kInf
       : off <= 0      ? 0
                       : off / allowed);
}

void Findings::holds(Law law, std::uint64_t number, int channel, double got,
                     double wanted, bool true_) {
  take(law, number, channel, got, wanted, 0, true_ ? 0 : kInf);
}

void Findings::same(Law law, std::uint64_t number, int channel, float got, float wanted) {
  const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
  holds(law, number, channel, double(got), double(wanted), bits(got) == bits(wanted));
}

void Findings::add(const Findings& other) {
  for (std::size_t k = 0; k < of.size(); ++k) {
    Finding sum = of[k];
    const Finding& f = other.of[k];
    const bool theirs = sum.checked == 0 || f.worst > sum.worst ||
                        (f.worst == sum.worst && f.worst_case < sum.worst_case);
    if (f.checked > 0 && theirs) {
      sum = f;
      sum.checked = of[k].checked + f.checked;
      sum.broken = of[k].broken + f.broken;
    } else {
      sum.checked += f.checked;
      sum.broken += f.broken;
    }
    sum.undecided = of[k].undecided + f.undecided;
    of[k] = sum;
  }
}

}  // namespace brume::stress
