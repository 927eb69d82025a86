// SPDX-License-Identifier: Apache-2.0
#include "session/lowest_coefficients.hpp"

#include <numeric>

#include "engine/tables.hpp"
#include "session/greys.hpp"

namespace fathom {

LowestCoefficients::LowestCoefficients(const MetricSpec& spec)
    : n_(spec.n), waves_{tables::taper(spec.taper, spec.n), {}, {}} {
  const auto turns = tables::twiddles(2 * n_);
  half_pixel_ = std::conj(turns[1]);
  for (std::size_t x = 0; x < waves_.even.size(); ++x) {
    waves_.cosine.push_back(waves_.even[x] * turns[2 * x + 1].real());
    waves_.sine.push_back(waves_.even[x] * turns[2 * x + 1].imag());
  }
  columns_ = waves_;
}

void LowestCoefficients::sum_columns(const Frame& frame, const Window& window) {
  const auto n = static_cast<std::size_t>(n_);
  read_greys(frame, window, greys_);
  for (auto* sums : {&columns_.even, &columns_.cosine, &columns_.sine}) sums->assign(n, 0.0);
  double *const even = columns_.even.data(), *const cosine = columns_.cosine.data();
  double* const sine = columns_.sine.data();
  for (std::size_t y = 0; y < n / 2; ++y) {
    // Seen from the middle, taper and cosine are even, and the sine is odd.
    const std::int32_t *const above = greys_.data() + y * n, *const below =
                                                                 greys_.data() + (n - 1 - y) * n;
    const double a = waves_.even[y], b = waves_.cosine[y], c = waves_.sine[y];
    for (std::size_t x = 0; x < n; ++x) {
      const double both = above[x] + below[x], difference = above[x] - below[x];
      even[x] += a * both;
      cosine[x] += b * both;
      sine[x] += c * difference;
    }
  }
}

LowestCoefficients::Values LowestCoefficients::of(const Frame& frame, const Window& window) {
  sum_columns(frame, window);
  const double scale = 1.0 / (static_cast<double>(n_) * n_);
  const auto along = [&](const std::vector<double>& wave, const std::vector<double>& column) {
    return scale * std::inner_product(wave.begin(), wave.end(), column.begin(), 0.0);
  };
  using Complex = std::complex<double>;
  // One column sum is real, and that of v = 1 has two parts: each is a row of real numbers.
  const auto row_of = [&](const std::vector<double>& column) {
    const Complex first(along(waves_.cosine, column), along(waves_.sine, column));
    return std::array<Complex, kAcross>{std::conj(first), along(waves_.even, column), first};
  };
  const auto middle = row_of(columns_.even), cosine = row_of(columns_.cosine);
  const auto sine = row_of(columns_.sine);
  const std::array<Complex, kAcross> phases{std::conj(half_pixel_), 1, half_pixel_};
  constexpr Complex i(0, 1);
  Values values;
  for (std::size_t u = 0; u < kAcross; ++u) {
    const Complex phase = phases[u];
    values[u] = phase * phases[0] * (cosine[u] - i * sine[u]);
    values[kAcross + u] = phase * middle[u];
    values[2 * kAcross + u] = phase * phases[2] * (cosine[u] + i * sine[u]);
  }
  return values;
}

}  // namespace fathom
