// SPDX-License-Identifier: Apache-2.0
// FFTW in single precision: widen and taper -> planned 2-D real transform -> weighted magnitudes.
// Small windows also go many to a plan (fftwf_plan_many_dft_r2c), where that is faster.
#include "bench/peers/by_size.hpp"
#include "bench/peers/fftw_plan.hpp"
#include "bench/peers/kernels.hpp"
#include "bench/peers/peer.hpp"
#include "bench/peers/tables.hpp"

namespace fathom::bench {
namespace {

/// Windows of one plan of small ones: as many as the first-level cache holds with their spectra.
/// 1: large ones gain nothing.
constexpr int windows_of_many(int n) { return n <= 8 ? 32 : n <= 16 ? 16 : n <= 32 ? 4 : 1; }

template <int N>
class Fftw final : public PreparedPeer {
 public:
  explicit Fftw(Planning planning) : one_(planned(1, planning)) {
    if (kMany == 1) return;
    many_ = planned(kMany, planning);
    // Without measurements both are used, so that the scores of both are compared.
    if (planning == Planning::patient && one_->run_time() * kMany <= many_->run_time())
      many_.reset();
  }

  void score(const Frame& frame, std::span<const Window> windows,
             std::span<double> scores) override {
    std::size_t done = 0;
    while (done < windows.size()) {
      const bool fills = many_ && windows.size() - done >= kMany;
      FftwPlan& plan = fills ? *many_ : *one_;
      const std::size_t count = fills ? kMany : 1;
      for (std::size_t i = 0; i < count; ++i)
        widen(frame, windows[done + i], plan.input() + i * distance(plan.is_in_place()),
              plan.is_in_place());
      plan.execute();
      for (std::size_t i = 0; i < count; ++i)
        scores[done + i] = factor_ * moment(plan.output() + i * 2 * kHalfPlane);
      done += count;
    }
  }

 private:
  static constexpr int kHalfPlane = N * (N / 2 + 1);
  static constexpr std::size_t kMany = windows_of_many(N);

  /// Floats from one window's pixels to the next one's. In place, rows are as long as the
  /// spectrum's.
  static constexpr int distance(bool in_place) { return in_place ? 2 * kHalfPlane : N * N; }

  static std::unique_ptr<FftwPlan> planned(int count, Planning planning) {
    return std::make_unique<FftwPlan>(static_cast<std::size_t>(count) * 2 * kHalfPlane, planning,
                                      [count](float* in, float* out, unsigned flags) {
                                        constexpr int kSides[] = {N, N};
                                        return fftwf_plan_many_dft_r2c(
                                            2, kSides, count, in, nullptr, 1, distance(in == out),
                                            reinterpret_cast<fftwf_complex*>(out), nullptr, 1,
                                            kHalfPlane, flags);
                                      });
  }

  void widen(const Frame& frame, const Window& window, float* to, bool in_place) const {
    // Two short tables instead of one of N * N: they leave the L1 cache to the transform.
    const float* const taper = aligned(taper_.get());
    to = aligned(to);
    const int pitch = in_place ? N + 2 : N;
    for (int y = 0; y < N; ++y) {
      const std::uint8_t* const from = window_row(frame, window, y);
      for (int x = 0; x < N; ++x) to[y * pitch + x] = from[x] * (taper[y] * taper[x]);
    }
  }

  double moment(const float* spectrum) const {
    const float* const z = aligned(spectrum);
    const float* const weight = aligned(weights_.get());
    return blocked_sum<kHalfPlane>([=](int i) {
      return weight[i] * std::sqrt(z[2 * i] * z[2 * i] + z[2 * i + 1] * z[2 * i + 1]);
    });
  }

  std::unique_ptr<FftwPlan> one_;
  std::unique_ptr<FftwPlan> many_;  ///< None where one window at a time is as fast.
  Buffer<float> taper_ = aligned_copy(hann_taper(N));
  Buffer<float> weights_ = aligned_copy(half_plane_weights(N));
  double factor_ = score_factor(N);
};

}  // namespace

std::unique_ptr<PreparedPeer> prepare_fftw(int n, Planning planning) {
  return prepare_by_size<Fftw>(n, planning);
}

}  // namespace fathom::bench
