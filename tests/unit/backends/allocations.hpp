// SPDX-License-Identifier: Apache-2.0
// Counts what this program takes from the heap, on any thread, by operator new, by malloc and its
// family, or, from inside a library, by either.
#pragma once

#include <cstddef>

namespace fathom::test {

/// Allocations since the program began.
std::size_t allocations();

}  // namespace fathom::test
