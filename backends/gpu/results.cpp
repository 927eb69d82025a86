// SPDX-License-Identifier: Apache-2.0
#include "backends/gpu/results.hpp"

#include <bit>
#include <numeric>

#include "engine/measure.hpp"
#include "engine/tables.hpp"

namespace fathom::gpu {
namespace {

double number(std::uint32_t word) { return double{std::bit_cast<float>(word)}; }

double integer(const std::uint32_t* words) {
  return static_cast<double>(std::uint64_t{words[1]} << 32 | words[0]);
}

std::size_t words_of(const MetricSpec& spec) {
  switch (spec.measure) {
    case Measure::moment:
    case Measure::entropy:
      return 2;
    case Measure::rings:
      return spec.outputs() * (spec.is_exact() ? 2 : 1);
  }
  return 0;
}

/// Kernels sum half of the plane for fft, all of it for the others.
double part_of_plane(TransformFamily family) {
  switch (family) {
    case TransformFamily::fourier:
      return 0.5;
    case TransformFamily::walsh:
    case TransformFamily::cosine:
      return 1;
  }
  return 1;
}

std::vector<double> ring_divisors(const MetricSpec& spec) {
  std::vector<double> divisors;
  switch (spec.measure) {
    case Measure::moment:
    case Measure::entropy:
      break;
    case Measure::rings:
      const double coefficient = tables::coefficient_scale(spec.transform, spec.n);
      const double unit = 1 / (spec.power ? coefficient * coefficient : coefficient);
      const Rings rings(spec);
      for (const std::uint32_t count : rings.coefficients()) {
        divisors.push_back(count * part_of_plane(family_of(spec.transform)) * unit);
      }
  }
  return divisors;
}

/// From the sum over the coefficients to the score: the moment's factor, or the mean of an entropy's
/// terms.
double sum_scale(const MetricSpec& spec) {
  switch (spec.measure) {
    case Measure::moment:
      return tables::moment_scale(spec);
    case Measure::entropy: {
      const auto terms = tables::entropy_weights(spec);
      return 1 / std::accumulate(terms.begin(), terms.end(), 0.0);
    }
    case Measure::rings:
      break;  // each has a divisor of its own
  }
  return 0;
}

}  // namespace

Results::Results(const MetricSpec& spec)
    : spec_(spec),
      words_(words_of(spec)),
      sum_scale_(sum_scale(spec)),
      ring_divisors_(ring_divisors(spec)) {}

void Results::read(const std::uint32_t* words, std::span<double> values) const {
  const bool is_exact = spec_.is_exact();
  switch (spec_.measure) {
    case Measure::moment:
    case Measure::entropy:
      values[0] = sum_scale_ * (is_exact ? integer(words) : number(words[0]) + number(words[1]));
      return;
    case Measure::rings:
      for (std::size_t k = 0; k < values.size(); ++k) {
        const double sum = is_exact ? integer(words + 2 * k) : number(words[k]);
        values[k] = sum / ring_divisors_[k];  // whole numbers: rounded once
      }
      return;
  }
}

}  // namespace fathom::gpu
