#pragma once
// Cutting n rays into blocks that kernels can take: a multiple of 16, at most kBlock.
// What is left over at the end is copied into a block of its own, filled up with its last
// ray, so that every ray meets the same code whatever n and alignment are.

#include <algorithm>
#include <vector>

#include "air/impl.h"

namespace brume::air {

/// Input and output planes that travel together; null planes stay null.
class Planes {
 public:
  void in(const float** p) { ins_.push_back(p); }
  void out(float** p) { outs_.push_back(p); }

  /// Calls work(offset, m) for every block, the registered pointers set to the block's
  /// first element, m a multiple of 16.
  template <class Work>
  void each_block(int n, Work work) {
    std::vector<const float*> in0;
    std::vector<float*> out0;
    for (auto p : ins_) in0.push_back(*p);
    for (auto p : outs_) out0.push_back(*p);
    const int whole = n - n % 16;
    for (int i = 0; i < whole; i += kBlock) {
      for (std::size_t j = 0; j < ins_.size(); ++j)
        if (in0[j]) *ins_[j] = in0[j] + i;
      for (std::size_t j = 0; j < outs_.size(); ++j)
        if (out0[j]) *outs_[j] = out0[j] + i;
      work(i, std::min(kBlock, whole - i));
    }
    if (whole < n) {
      std::vector<float> room((ins_.size() + outs_.size()) * 16);
      float* p = room.data();
      for (std::size_t j = 0; j < ins_.size(); ++j, p += 16) {
        if (!in0[j]) continue;
        for (int k = 0; k < 16; ++k) p[k] = in0[j][std::min(whole + k, n - 1)];
        *ins_[j] = p;
      }
      float* first_out = p;
      for (std::size_t j = 0; j < outs_.size(); ++j, p += 16)
        if (out0[j]) *outs_[j] = p;
      work(whole, 16);
      p = first_out;
      for (std::size_t j = 0; j < outs_.size(); ++j, p += 16)
        if (out0[j]) std::copy(p, p + (n - whole), out0[j] + whole);
    }
    for (std::size_t j = 0; j < ins_.size(); ++j) *ins_[j] = in0[j];
    for (std::size_t j = 0; j < outs_.size(); ++j) *outs_[j] = out0[j];
  }

 private:
  std::vector<const float**> ins_;
  std::vector<float**> outs_;
};

}  // namespace brume::air
