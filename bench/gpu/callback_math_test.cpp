// SPDX-License-Identifier: Apache-2.0
// What cuFFT's callbacks of the CUDA peer compute, on the host: pixels by their place in a batch, a
// direct transform in cuFFT's stead, coefficients into sums. The scores are those of `reference`.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <span>
#include <vector>

#include "backends/backends.hpp"
#include "cuda_peer/callback_math.hpp"
#include "cuda_peer/metric.cuh"
#include "engine/scorer.hpp"

namespace {

using namespace fathom::peer;

/// A frame of noise on a ramp, with windows that neither tile it nor stand in its order.
template <class Pixel>
struct Picture {
  explicit Picture(int side) : n(side), width(3 * side + 5), pixels(pixel_count()) {
    std::mt19937 random(1989);
    const unsigned largest = sizeof(Pixel) == 1 ? 255 : 4095;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      pixels[i] = static_cast<Pixel>((i + random() % 64) % (largest + 1));
    }
    windows = {{n + 4, 3, n}, {0, 0, n}, {2 * n + 5, n + 2, n}, {1, n / 2, n}};
    for (const fathom::Window& window : windows) {
      origins.push_back(
          static_cast<std::uint32_t>((window.y * width + window.x) * int{sizeof(Pixel)}));
    }
  }
  std::size_t pixel_count() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(2 * n + 2);
  }

  int n, width;
  std::vector<Pixel> pixels;
  std::vector<fathom::Window> windows;
  std::vector<std::uint32_t> origins;
};

/// As CallbackPipeline::run, cuFFT's order of elements included.
template <int kLogN, bool kPower, class Pixel>
std::vector<double> callback_scores(const Picture<Pixel>& picture, const Metric& metric) {
  constexpr std::size_t kN = HalfPlane<kLogN>::kN, kCount = HalfPlane<kLogN>::kCount;
  constexpr std::size_t kSlots = sum_slots(int{kN});
  const std::vector<float> taper = hann(metric.n);
  std::vector<float> sums(picture.windows.size() * kSlots);
  const CallbackInfo info = {reinterpret_cast<const unsigned char*>(picture.pixels.data()),
                             static_cast<std::size_t>(picture.width) * sizeof(Pixel),
                             picture.origins.data(), taper.data(), sums.data()};
  const auto waves = fourier_basis(metric.n);
  std::vector<double> scores;
  for (std::size_t window = 0; window < picture.windows.size(); ++window) {
    std::vector<double> pixels;
    for (std::size_t i = 0; i < kN * kN; ++i) {
      pixels.push_back(double{load_pixel<kLogN, Pixel>(info, window * kN * kN + i)});
    }
    const auto spectrum = direct(pixels, waves, metric.n, metric.n / 2 + 1);
    for (std::size_t i = 0; i < kCount; ++i) {
      add_coefficient<kLogN, kPower>(info, window * kCount + i,
                                     static_cast<float>(spectrum[i].real()),
                                     static_cast<float>(spectrum[i].imag()));
    }
    double sum = 0;
    for (std::size_t slot = 0; slot < kSlots; ++slot) sum += double{sums[window * kSlots + slot]};
    scores.push_back(scale(metric) * sum);
  }
  return scores;
}

/// How many windows of one metric differ by more than single precision explains.
template <int kLogN, bool kPower, class Pixel>
int wrong_scores() {
  const Metric metric = {false, kPower, 1 << kLogN, 8 * int{sizeof(Pixel)}};
  Picture<Pixel> picture(metric.n);
  const std::vector<double> ours = callback_scores<kLogN, kPower>(picture, metric);
  const fathom::MetricSpec spec = fathom::MetricSpec::parse(metric.text());
  fathom::Scorer scorer(fathom::select_device(fathom::all_backends(), "reference", spec, 1), spec,
                        picture.windows);
  std::vector<double> theirs(ours.size());
  scorer.score(fathom::Frame(picture.width, 2 * metric.n + 2, picture.pixels), theirs);
  int wrong = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    if (theirs[i] > 0 && std::abs(ours[i] / theirs[i] - 1) <= 1e-5) continue;
    fmt::print("{}, {} bits, window {}: {:.9g}, and reference says {:.9g}\n", metric.text(),
               metric.depth, i, ours[i], theirs[i]);
    ++wrong;
  }
  return wrong;
}

/// The weights of a half plane are those of the whole: SUM u^2 + v^2 for u, v = -N/2 .. N/2 - 1.
template <int kLogN>
int wrong_weights() {
  constexpr int kN = 1 << kLogN;
  double whole = 0, half = 0;
  for (int u = -kN / 2; u < kN / 2; ++u) whole += 2.0 * kN * u * u;
  for (unsigned i = 0; i < HalfPlane<kLogN>::kCount; ++i) half += double{weight<kLogN>(i)};
  if (whole == half) return 0;  // whole numbers, all exact
  fmt::print("N = {}: weights add up to {}, not {}\n", kN, half, whole);
  return 1;
}

template <int kLogN>
int wrong_of_side() {
  return wrong_scores<kLogN, false, std::uint8_t>() + wrong_scores<kLogN, true, std::uint8_t>() +
         wrong_scores<kLogN, false, std::uint16_t>() + wrong_scores<kLogN, true, std::uint16_t>();
}

}  // namespace

int main() {
  const int wrong = wrong_of_side<3>() + wrong_of_side<4>() + wrong_of_side<5>() +
                    wrong_of_side<6>() + wrong_weights<3>() + wrong_weights<6>() +
                    wrong_weights<7>() + wrong_weights<8>() + wrong_weights<9>();
  fmt::print("{} scores or weights are wrong\n", wrong);
  return wrong == 0 ? 0 : 1;
}
