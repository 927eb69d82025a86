// SPDX-License-Identifier: Apache-2.0
// FFHT, built from a folder that the user names: widen -> its transform in place -> weighted sum.
#include <fht.h>

#include <stdexcept>

#include "bench/peers/by_size.hpp"
#include "bench/peers/kernels.hpp"
#include "bench/peers/peer.hpp"
#include "bench/peers/tables.hpp"

namespace fathom::bench {
namespace {

constexpr int log2_of(int n) { return n == 1 ? 0 : 1 + log2_of(n / 2); }

template <int N>
class Ffht final : public PreparedPeer {
 public:
  explicit Ffht(Planning) {}

  void score(const Frame& frame, std::span<const Window> windows,
             std::span<double> scores) override {
    float* const values = aligned(values_.get());
    for (std::size_t i = 0; i < windows.size(); ++i) {
      widen<N>(frame, windows[i], values);
      if (fht_float(values, log2_of(N * N)) != 0) throw std::runtime_error("FFHT declined");
      scores[i] = factor_ * moment(values);
    }
  }

 private:
  double moment(const float* values) const {
    const float* const weight = aligned(weights_.get());
    return blocked_sum<N * N>([=](int i) { return weight[i] * std::abs(values[i]); });
  }

  Buffer<float> values_ = make_buffer<float>(N * N);
  Buffer<float> weights_ = aligned_copy(natural_order_weights(N));
  double factor_ = score_factor(N);
};

}  // namespace

std::unique_ptr<PreparedPeer> prepare_ffht(int n, Planning planning) {
  return prepare_by_size<Ffht>(n, planning);
}

}  // namespace fathom::bench
