// SPDX-License-Identifier: Apache-2.0
// Frames of a stack in an order that has nothing to do with the focus.
#pragma once

#include <cstddef>
#include <vector>

namespace fathom::depth {

/// The numbers below `count` in disorder, another one for each seed; the same in every run.
std::vector<std::size_t> disorder(std::size_t count, unsigned seed);

}  // namespace fathom::depth
