// SPDX-License-Identifier: Apache-2.0
// FFTW's cosine transform in single precision (REDFT10 along both axes), then the loop of an
// entropy: energy, masses, masses times their logarithms.
#include "bench/peers/by_size.hpp"
#include "bench/peers/fftw_plan.hpp"
#include "bench/peers/kernels.hpp"
#include "bench/peers/peer.hpp"
#include "bench/peers/tables.hpp"

namespace fathom::bench {
namespace {

template <int N>
class FftwDct final : public PreparedPeer {
 public:
  explicit FftwDct(Planning planning)
      : plan_(N * N, planning, [](float* in, float* out, unsigned flags) {
          return fftwf_plan_r2r_2d(N, N, in, out, FFTW_REDFT10, FFTW_REDFT10, flags);
        }) {}

  void score(const Frame& frame, std::span<const Window> windows,
             std::span<double> scores) override {
    for (std::size_t i = 0; i < windows.size(); ++i) {
      widen<N>(frame, windows[i], plan_.input());
      plan_.execute();
      scores[i] = entropy();
    }
  }

 private:
  /// Zero frequency is in the norm, and has no term.
  double entropy() {
    const float* const z = aligned(plan_.output());
    const float* const weight = aligned(weights_.get());
    float* const mass = aligned(masses_.get());
    for (int i = 0; i < N * N; ++i) mass[i] = weight[i] * std::abs(z[i]);
    const double energy = blocked_sum<N * N>([=](int i) { return mass[i] * mass[i]; });
    mass[0] = 0;
    const double masses = blocked_sum<N * N>([=](int i) { return mass[i]; });
    const double with_logs =
        blocked_sum<N * N>([=](int i) { return mass[i] * std::log2(mass[i] + 1e-30F); });
    if (masses == 0) return 0;
    const double norm = std::sqrt(energy);
    return (std::log2(norm) * masses - with_logs) / norm / (double{N} * N - 1);
  }

  FftwPlan plan_;
  Buffer<float> masses_ = make_buffer<float>(N * N);
  Buffer<float> weights_ = aligned_copy(orthonormal_weights(N));
};

}  // namespace

std::unique_ptr<PreparedPeer> prepare_fftw_dct(int n, Planning planning) {
  return prepare_by_size<FftwDct>(n, planning);
}

}  // namespace fathom::bench
