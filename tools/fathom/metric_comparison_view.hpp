// SPDX-License-Identifier: Apache-2.0
// How a comparison of metrics looks on the screen and on paper.
#pragma once

#include <string>

#include "engine/travel.hpp"
#include "tools/fathom/metric_comparison.hpp"

namespace fathom::cli {

/// A row for each method, and what the columns mean. unit: of the lens.
void print_table(const MetricComparison& comparison, const std::string& unit);

/// The consensus, and what is recommended and why, or why nothing is.
void print_result(const MetricComparison& comparison, const std::string& unit);

/// A JSON object for each method, then one of what they come to (docs/output.md).
void print_json(const MetricComparison& comparison, const std::string& unit);

/// All curves as SVG, from 0 far from focus to 1 at the highest. name: of the pictures. Throws as
/// write_curves.
void draw(const std::string& path, const MetricComparison& comparison, const std::string& name,
          const LensInfo& lens);

}  // namespace fathom::cli
