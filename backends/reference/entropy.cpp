// SPDX-License-Identifier: Apache-2.0
// The entropy of a normalised spectrum by its definition.
#include <cmath>

#include "backends/reference/formulas.hpp"

namespace fathom::reference {
namespace {

/// Zero frequency is in no band, and without one has no term either.
bool has_term(const MetricSpec& spec, int i, int j) {
  const double squared = static_cast<double>(i * i + j * j);
  return spec.band ? spec.band->contains(spec.transform, spec.n, squared) : squared > 0;
}

}  // namespace

double entropy(const Basis& basis, const Frame& frame, const Window& window) {
  const int n = basis.spec.n;
  const auto spectrum = cosine_spectrum(basis, frame, window);
  Real squares = 0, bits = 0;
  for (const Real c : spectrum) squares += c * c;
  if (squares == 0) return 0;  // all black
  int terms = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      if (!has_term(basis.spec, i, j)) continue;
      ++terms;
      const Real p = std::abs(spectrum[static_cast<std::size_t>(i) * n + j]) / std::sqrt(squares);
      if (p > 0) bits -= p * std::log2(p);
    }
  }
  return static_cast<double>(bits / terms);
}

}  // namespace fathom::reference
