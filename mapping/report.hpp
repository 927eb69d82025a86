// SPDX-License-Identifier: Apache-2.0
// report.json: how a map was made.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mapping/depth_result.hpp"

namespace fathom::mapping {

/// What the result does not know of itself.
struct ReportFacts {
  std::string made;         ///< When, UTC.
  std::string calibration;  ///< Its path, or empty.
  std::string window = "auto";
  std::optional<int> stride;
  std::string align;
  /// By how much the picture grows for each unit of position, as a part of the first one: what a law
  /// of optics told, and what was fitted. Nothing where frames alone tell how they lie.
  struct Growth {
    double told = 0;
    double fitted = 0;
  };
  std::optional<Growth> growth = std::nullopt;
  double moved_px = 0;  ///< Of the last frame against the first, at the corners.
  bool is_filled = false;
  std::size_t frames_expected = 0;
  std::string backend;
  double read_seconds = 0, map_seconds = 0, write_seconds = 0;
  std::vector<std::string> files;
};

/// One JSON object with line breaks between its members.
std::string report_json(const DepthResult& result, const DepthSummary& summary,
                        const ReportFacts& facts);

/// The most memory that this process has had, MB.
double peak_memory_mb();

}  // namespace fathom::mapping
