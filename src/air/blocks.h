#pragma once
// Cutting n rays into blocks that kernels can take: a multiple of 16, at most kBlock.
// What is left over at the end is copied into a block of its own, filled up with its last
// ray, so that every ray meets the same code whatever n and alignment are.

#include <algorithm>
#include <vector>

#include "air/impl.h"

namespace brume::air {

/// Input and output planes that travel together; null planes stay null. A thread keeps
/// one and starts it anew for every call, so that no call takes memory.
class Planes {
 public:
  void start() {
    ins_.clear();
    outs_.clear();
  }
  void in(const float** p) { ins_.push_back(p); }
  void out(float** p) { outs_.push_back(p); }

  /// Calls work(offset, m) for every block, the registered pointers set to the block's
  /// first element, m a multiple of 16.
  template <class Work>
  void each_block(int n, Work work) {
    in0_.clear();
    out0_.clear();
    for (auto p : ins_) in0_.push_back(*p);
    for (auto p : outs_) out0_.push_back(*p);
    const int whole = n - n % 16;
    for (int i = 0; i < whole; i += kBlock) {
      for (std::size_t j = 0; j < ins_.size(); ++j)
        if (in0_[j]) *ins_[j] = in0_[j] + i;
      for (std::size_t j = 0; j < outs_.size(); ++j)
        if (out0_[j]) *outs_[j] = out0_[j] + i;
      work(i, std::min(kBlock, whole - i));
    }
    if (whole < n) {
      room_.resize((ins_.size() + outs_.size()) * 16);
      float* p = room_.data();
      for (std::size_t j = 0; j < ins_.size(); ++j, p += 16) {
        if (!in0_[j]) continue;
        for (int k = 0; k < 16; ++k) p[k] = in0_[j][std::min(whole + k, n - 1)];
        *ins_[j] = p;
      }
      float* first_out = p;
      for (std::size_t j = 0; j < outs_.size(); ++j, p += 16)
        if (out0_[j]) *outs_[j] = p;
      work(whole, 16);
      p = first_out;
      for (std::size_t j = 0; j < outs_.size(); ++j, p += 16)
        if (out0_[j]) std::copy(p, p + (n - whole), out0_[j] + whole);
    }
    for (std::size_t j = 0; j < ins_.size(); ++j) *ins_[j] = in0_[j];
    for (std::size_t j = 0; j < outs_.size(); ++j) *outs_[j] = out0_[j];
  }

 private:
  std::vector<const float**> ins_;
  std::vector<float**> outs_;
  std::vector<const float*> in0_;
  std::vector<float*> out0_;
  std::vector<float> room_;
};

}  // namespace brume::air
