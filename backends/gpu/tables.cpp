// SPDX-License-Identifier: Apache-2.0
#include "backends/gpu/tables.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include "backends/gpu/rings.hpp"
#include "engine/tables.hpp"

namespace fathom::gpu {
namespace {

class Words {
 public:
  void add(float value) { words_.push_back(std::bit_cast<std::uint32_t>(value)); }
  void add_rounded(double value) { add(static_cast<float>(value)); }
  void add_all(const std::vector<std::uint32_t>& words) {
    words_.insert(words_.end(), words.begin(), words.end());
  }
  void add_rounded(std::complex<double> value) {
    add_rounded(value.real());
    add_rounded(value.imag());
  }
  /// As two floats (kernels/double_float.glsl).
  void add_split(double value) {
    const auto upper = static_cast<float>(value);
    add(upper);
    add_rounded(value - upper);
  }
  std::vector<std::uint32_t> take() { return std::move(words_); }

 private:
  std::vector<std::uint32_t> words_;
};

/// [k] k with its bits in reverse order: a Hadamard index is so made of a Paley index.
std::vector<int> reversed_bits(int n) { return tables::paley_index(Transform::walsh_hadamard, n); }

std::vector<double> arms_by_position(const MetricSpec& spec) {
  const auto arms = tables::lever_arms(spec.transform, spec.n);
  std::vector<double> by_position;
  for (const int index : index_by_position(spec)) by_position.push_back(arms[index]);
  return by_position;
}

std::vector<std::uint32_t> fft_words(const MetricSpec& spec) {
  Words words;
  for (const double w : tables::taper(spec.taper, spec.n)) words.add_rounded(w);
  for (const auto flat : tables::taper_spectrum(spec.taper, spec.n)) {
    words.add_rounded(flat * static_cast<double>(spec.n));
  }
  for (const auto root : tables::twiddles(spec.n)) words.add_rounded(root);
  switch (spec.measure) {
    case Measure::moment:
    case Measure::entropy:
      break;
    case Measure::rings:
      for (const RingRule& rule : ring_rules(spec)) {
        for (const double number : {rule.lead, rule.rest, rule.floor, rule.brightness})
          words.add_rounded(number);
      }
      words.add_all(ring_words_by_frequency(spec));
  }
  return words.take();
}

std::vector<std::uint32_t> walsh_words(const MetricSpec& spec) {
  std::vector<std::uint32_t> words;
  for (const double arm : arms_by_position(spec)) words.push_back(static_cast<std::uint32_t>(arm));
  switch (spec.measure) {
    case Measure::moment:
    case Measure::entropy:
      break;
    case Measure::rings:
      const auto rings = ring_words_by_position(spec);
      words.insert(words.end(), rings.begin(), rings.end());
  }
  return words;
}

/// SUM w(x) w(y).
double weight_of_window(const MetricSpec& spec) {
  const auto taper = tables::taper(spec.taper, spec.n);
  const double sum = std::accumulate(taper.begin(), taper.end(), 0.0);
  return sum * sum;
}

/// Turns from a Fourier to a cosine transform, and where each frequency stands.
void add_cosine_words(int n, Words& words) {
  const auto roots = tables::twiddles(4 * n);
  for (int k = 0; k < n; ++k) {
    const double twice = k == 0 ? 1 : std::numbers::sqrt2;
    words.add_split(twice * roots[k].real());
    words.add_split(twice * -roots[k].imag());
  }
  for (const int position : reversed_bits(n)) words.add_rounded(position);
}

std::vector<std::uint32_t> exact_words(const MetricSpec& spec) {
  Words words;
  for (const double w : tables::taper(spec.taper, spec.n)) words.add_split(w);
  const auto roots = tables::twiddles(spec.n);
  for (int k = 0; k < spec.n / 2; ++k) {
    words.add_split(roots[k].real());
    words.add_split(roots[k].imag());
  }
  for (const double arm : arms_by_position(spec)) words.add_rounded(arm);
  if (family_of(spec.transform) == TransformFamily::cosine) add_cosine_words(spec.n, words);
  switch (spec.measure) {
    case Measure::moment:
    case Measure::entropy:
      break;
    case Measure::rings:
      words.add_split(1 / weight_of_window(spec));
      words.add_all(ring_words_by_position(spec));
  }
  return words.take();
}

/// Kernels hold 2 N^2 F, of half of the plane: per root of the energy twice the noise of N^2 F.
constexpr double kKernelNoise = 2 * tables::kFloatNoise;

void set_moment_doubt(kernels::ScoreArgs& args, const MetricSpec& spec) {
  args.tolerance = static_cast<float>(tables::kFloatTolerance);
  if (spec.power) {
    // One grey level a window is taken off, so that rounding may be the same in every column and
    // land where the picture is: docs/metrics.md, "power".
    constexpr double kInPhase = 12;
    args.noise =
        static_cast<float>(kInPhase * tables::least_trusted(spec) / tables::moment_scale(spec));
    return;
  }
  constexpr double kSigmas = 8;
  args.noise = static_cast<float>(kKernelNoise);
  double second_moment = 0, fourth_moment = 0;  // SUM r^2, SUM r^4 over the plane
  const auto arms = tables::lever_arms(spec.transform, spec.n);
  for (const double v : arms) {
    for (const double u : arms) {
      second_moment += u + v;
      fourth_moment += (u + v) * (u + v);
    }
  }
  args.in_phase = static_cast<float>(second_moment / 2);
  // Of each coefficient's noise the half in its own phase counts.
  args.spread = static_cast<float>(kSigmas * std::sqrt(fourth_moment / 2 / 2));
}

void set_doubt(kernels::ScoreArgs& args, const MetricSpec& spec) {
  switch (family_of(spec.transform)) {
    case TransformFamily::walsh:
    case TransformFamily::cosine:
      return;  // integers, or kernels/exact
    case TransformFamily::fourier:
      break;
  }
  switch (spec.measure) {
    case Measure::moment:
      return set_moment_doubt(args, spec);
    case Measure::rings:
      args.noise = static_cast<float>(kKernelNoise);
      args.tolerance = static_cast<float>(kRingTolerance);
      return;
    case Measure::entropy:
      return;  // of no Fourier transform
  }
}

void set_band(kernels::ScoreArgs& args, const MetricSpec& spec) {
  if (!spec.band) return;
  // Squared radii are integers, so the metric's own definition is asked for each once, here.
  const auto largest = static_cast<std::uint32_t>(2 * spec.n * spec.n);
  for (std::uint32_t squared = 0; squared <= largest; ++squared) {
    if (!spec.band->contains(spec.transform, spec.n, squared)) continue;
    if (args.band_to == 0) args.band_above = squared - 1;
    args.band_to = squared;
  }
}

}  // namespace

std::vector<std::uint32_t> table_words(const MetricSpec& spec, Kernel kernel) {
  switch (kernel) {
    case Kernel::fft:
      return fft_words(spec);
    case Kernel::walsh_float:
    case Kernel::walsh_integer:
      return walsh_words(spec);
    case Kernel::exact:
      break;
  }
  return exact_words(spec);
}

std::vector<int> index_by_position(const MetricSpec& spec) {
  const int n = spec.n;
  auto reversed = reversed_bits(n);
  switch (family_of(spec.transform)) {
    case TransformFamily::fourier:
      return reversed;
    case TransformFamily::walsh:
      break;
    case TransformFamily::cosine:
      std::ranges::sort(reversed);  // kernels/exact puts them in order
      return reversed;
  }
  const auto paley = tables::paley_index(spec.transform, n);
  std::vector<int> index(n);
  for (int i = 0; i < n; ++i) index[reversed[paley[i]]] = i;
  return index;
}

int touched_frequency(const MetricSpec& spec) {
  const auto flat = tables::taper_spectrum(spec.taper, spec.n);
  int touched = spec.n / 2;
  while (touched > 0 && flat[touched] == 0.0) --touched;
  return touched;
}

kernels::ScoreArgs args_for(const MetricSpec& spec) {
  kernels::ScoreArgs args = {};
  set_doubt(args, spec);
  set_band(args, spec);
  return args;
}

}  // namespace fathom::gpu
