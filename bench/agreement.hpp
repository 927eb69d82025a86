// SPDX-License-Identifier: Apache-2.0
// The proof that everything that is timed does equal work: its scores are those of `reference`.
#pragma once

#include <cstddef>
#include <string_view>

#include "bench/contestants.hpp"

namespace fathom::bench {

/// The largest relative error of the scores of the first scattered windows.
double largest_error(const Scorer& scorer, const MetricSpec& spec, std::size_t window_count);

/// What largest_error() may be: single precision without the care that Fathom takes.
double tolerance(const MetricSpec& spec);

/// Throws std::runtime_error naming the contestant unless one window's score agrees.
void require_agreement(std::string_view name, const Scorer& scorer, const MetricSpec& spec);

}  // namespace fathom::bench
