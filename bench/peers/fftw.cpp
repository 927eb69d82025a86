// SPDX-License-Identifier: Apache-2.0
// FFTW in single precision: widen and taper -> planned 2-D real transform -> weighted magnitudes.
#include "bench/peers/by_size.hpp"
#include "bench/peers/fftw_plan.hpp"
#include "bench/peers/kernels.hpp"
#include "bench/peers/peer.hpp"
#include "bench/peers/tables.hpp"

namespace fathom::bench {
namespace {

template <int N>
class Fftw final : public PreparedPeer {
 public:
  explicit Fftw(Planning planning)
      : plan_(2 * kHalfPlane, planning, [](float* in, float* out, unsigned flags) {
          return fftwf_plan_dft_r2c_2d(N, N, in, reinterpret_cast<fftwf_complex*>(out), flags);
        }) {}

  void score(const Frame& frame, std::span<const Window> windows,
             std::span<double> scores) override {
    for (std::size_t i = 0; i < windows.size(); ++i) {
      widen(frame, windows[i]);
      plan_.execute();
      scores[i] = factor_ * moment();
    }
  }

 private:
  static constexpr int kHalfPlane = N * (N / 2 + 1);

  void widen(const Frame& frame, const Window& window) {
    // Two short tables instead of one of N * N: they leave the L1 cache to the transform.
    const float* const taper = aligned(taper_.get());
    float* const to = aligned(plan_.input());
    const int pitch = plan_.is_in_place() ? N + 2 : N;
    for (int y = 0; y < N; ++y) {
      const std::uint8_t* const from = window_row(frame, window, y);
      for (int x = 0; x < N; ++x) to[y * pitch + x] = from[x] * (taper[y] * taper[x]);
    }
  }

  double moment() const {
    const float* const z = aligned(plan_.output());
    const float* const weight = aligned(weights_.get());
    return blocked_sum<kHalfPlane>([=](int i) {
      return weight[i] * std::sqrt(z[2 * i] * z[2 * i] + z[2 * i + 1] * z[2 * i + 1]);
    });
  }

  FftwPlan plan_;
  Buffer<float> taper_ = aligned_copy(hann_taper(N));
  Buffer<float> weights_ = aligned_copy(half_plane_weights(N));
  double factor_ = score_factor(N);
};

}  // namespace

std::unique_ptr<PreparedPeer> prepare_fftw(int n, Planning planning) {
  return prepare_by_size<Fftw>(n, planning);
}

}  // namespace fathom::bench
