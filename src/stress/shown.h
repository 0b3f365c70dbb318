#pragma once
// A world as surface stages are shown it while they run: with the product's answers, or
// with the truth's.

#include "pipeline/impl.h"
#include "truth/shown.h"

namespace brume::stress {

/// Copies the world; what its functions point into is the caller's to keep. Neither of
/// the two outlives it.
class Shown {
 public:
  Shown(const World&, const AirOptions&);
  Shown(const Shown&) = delete;
  Shown& operator=(const Shown&) = delete;

  const brume_world& fast() const { return fast_; }
  const brume_world& truth() const { return truth_.table(); }
  const World& world() const { return frame_.world; }

 private:
  PreparedFrame::Impl frame_;
  brume_world fast_;
  truth::Shown truth_;
};

}  // namespace brume::stress
