// SPDX-License-Identifier: Apache-2.0
// FFTW as a Walsh-Hadamard transform: a DFT of size 2 x 2 x ... x 2 is one, in natural order.
//
// Neighbouring pixels go in as one complex number, because FFTW has vector code for complex
// transforms of size 2 and none for real ones (twice to five times slower). The last butterfly,
// within each complex number, is left to the sum.
#include <array>

#include "bench/peers/by_size.hpp"
#include "bench/peers/fftw_plan.hpp"
#include "bench/peers/kernels.hpp"
#include "bench/peers/peer.hpp"
#include "bench/peers/tables.hpp"

namespace fathom::bench {
namespace {

constexpr int log2_of(int n) { return n == 1 ? 0 : 1 + log2_of(n / 2); }

template <int N>
class FftwWalsh final : public PreparedPeer {
 public:
  explicit FftwWalsh(Planning planning)
      : plan_(N * N, planning, [](float* in, float* out, unsigned flags) {
          std::array<int, log2_of(N * N / 2)> sides;
          sides.fill(2);
          return fftwf_plan_dft(static_cast<int>(sides.size()), sides.data(),
                                reinterpret_cast<fftwf_complex*>(in),
                                reinterpret_cast<fftwf_complex*>(out), FFTW_FORWARD, flags);
        }) {}

  void score(const Frame& frame, std::span<const Window> windows,
             std::span<double> scores) override {
    for (std::size_t i = 0; i < windows.size(); ++i) {
      widen<N>(frame, windows[i], plan_.input());
      plan_.execute();
      scores[i] = factor_ * moment();
    }
  }

 private:
  double moment() const {
    const float* const z = aligned(plan_.output());
    const float* const weight = aligned(weights_.get());
    return blocked_sum<N * N / 2>([=](int i) {
      const float even = z[2 * i];
      const float odd = z[2 * i + 1];
      return weight[2 * i] * std::abs(even + odd) + weight[2 * i + 1] * std::abs(even - odd);
    });
  }

  FftwPlan plan_;
  Buffer<float> weights_ = aligned_copy(natural_order_weights(N));
  double factor_ = score_factor(N);
};

}  // namespace

std::unique_ptr<PreparedPeer> prepare_fftw_walsh(int n, Planning planning) {
  return prepare_by_size<FftwWalsh>(n, planning);
}

}  // namespace fathom::bench
