// SPDX-License-Identifier: Apache-2.0
// The proof that everything that is timed does equal work: its scores are those of `reference`;
// other metrics' are those of plain loops.
#pragma once

#include <cstddef>
#include <string_view>

#include "bench/contestants.hpp"
#include "bench/other_metrics.hpp"

namespace fathom::bench {

/// The largest relative error of the scores of the first scattered windows.
double largest_error(const Scorer& scorer, const MetricSpec& spec, std::size_t window_count);

double largest_error(const Scorer& scorer, const OtherMetric& metric, int n,
                     std::size_t window_count);

/// What largest_error() may be: single precision without the care that Fathom takes.
double tolerance(const MetricSpec& spec);
inline constexpr double kOtherTolerance = 1e-6;

/// Throws std::runtime_error naming the contestant unless one window's score agrees.
void require_agreement(std::string_view name, const Scorer& scorer, const MetricSpec& spec);
void require_agreement(const Scorer& scorer, const OtherMetric& metric, int n);

}  // namespace fathom::bench
