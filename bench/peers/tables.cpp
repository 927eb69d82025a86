// SPDX-License-Identifier: Apache-2.0
#include "bench/peers/tables.hpp"

#include <cmath>
#include <cstddef>

#include "engine/metric.hpp"
#include "engine/tables.hpp"

namespace fathom::bench {

std::vector<float> hann_taper(int n) {
  const auto taper = tables::taper(Taper::hann(), n);
  return {taper.begin(), taper.end()};
}

std::vector<float> half_plane_weights(int n) {
  const auto arms = tables::lever_arms(Transform::fft, n);
  std::vector<float> weights;
  for (int v = 0; v < n; ++v) {
    for (int u = 0; u <= n / 2; ++u) {
      const double stands_for = u == 0 || u == n / 2 ? 1 : 2;
      weights.push_back(static_cast<float>(stands_for / 2 * (arms[u] + arms[v])));
    }
  }
  return weights;
}

std::vector<float> natural_order_weights(int n) {
  const auto arms = tables::lever_arms(Transform::walsh_sequency, n);
  const auto sequency_paley = tables::paley_index(Transform::walsh_sequency, n);
  const auto natural_paley = tables::paley_index(Transform::walsh_hadamard, n);
  std::vector<double> natural_arms(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    // Coefficient i of the sequency order is Paley's p; natural order has it where p is reversed,
    // and reversing twice changes nothing.
    natural_arms[natural_paley[sequency_paley[i]]] = arms[i];
  }
  std::vector<float> weights;
  for (const double row : natural_arms) {
    for (const double col : natural_arms) weights.push_back(static_cast<float>(row + col));
  }
  return weights;
}

std::vector<float> orthonormal_weights(int n) {
  std::vector<float> weights;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double squared = (i == 0 ? 0.5 : 1) * (j == 0 ? 0.5 : 1);
      weights.push_back(static_cast<float>(std::sqrt(squared)));
    }
  }
  return weights;
}

double score_factor(int n) { return std::pow(n, -6); }

}  // namespace fathom::bench
