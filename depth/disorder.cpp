// SPDX-License-Identifier: Apache-2.0
#include "depth/disorder.hpp"

#include <numeric>
#include <random>
#include <utility>

namespace fathom::depth {

std::vector<std::size_t> disorder(std::size_t count, unsigned seed) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::mt19937 random(seed);
  for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[random() % i]);
  return order;
}

}  // namespace fathom::depth
