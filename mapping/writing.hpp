// SPDX-License-Identifier: Apache-2.0
// Every file that fathom depth leaves.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "mapping/depth_result.hpp"
#include "mapping/output_folder.hpp"
#include "mapping/report.hpp"

namespace fathom::mapping {

/// What is asked for beside the files that are always made.
struct ExtraFiles {
  bool ply = false;
  bool obj = false;
  bool sharp_tiff = false;  ///< sharp.tif in place of sharp.png.
};

/// Writes all pictures and the page, on two threads, and returns their names in order. Throws
/// Error(io) and Error(out_of_memory); `folder` is then left without them.
std::vector<std::string> write_files(const DepthResult& result, const DepthSummary& summary,
                                     const ExtraFiles& extra, const OutputFolder& folder);

/// Writes them, and report.json with the time that it took; facts.files gets their names. The folder
/// shows none of them before its move_in(). Throws as write_files().
void write_map(const DepthResult& result, const DepthSummary& summary, const ExtraFiles& extra,
               ReportFacts& facts, const OutputFolder& folder);

}  // namespace fathom::mapping
