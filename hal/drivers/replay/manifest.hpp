// SPDX-License-Identifier: Apache-2.0
// The manifest of a recorded stack: which picture was taken at which lens position.
//
// A file `manifest.csv` beside the pictures:
//
//   # unit: steps
//   # coarse_spacing: 100
//   file,position
//   frame_0000.png,0
//   frame_0001.png,12.5
//
// The first line that is no comment names the columns: `file` and `position`, and `page` where the
// pictures are pages of TIFFs (0-based); others are not looked at. Capitals do not matter. Semicolons
// or tabs may stand for the commas, and then positions may have decimal commas. Several pictures may
// have one position, but no picture two. Paths are relative to the manifest's folder; one with a
// comma or a quote stands in double quotes, as in every CSV. Of the comments only `# unit:` (of the
// positions) and `# coarse_spacing:` (LensInfo::coarse_spacing) mean something; both may be left
// out.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fathom {

inline constexpr std::string_view kManifestName = "manifest.csv";

struct ManifestEntry {
  std::string file;      ///< Relative to the manifest's folder.
  double position = 0;   ///< Of the lens, in the manifest's unit.
  std::size_t page = 0;  ///< Of a multi-page TIFF.
  int line = 0;          ///< Where it stands in the text, for error messages; 0 if it was not read.
};

struct Manifest {
  std::string unit = "units";  ///< "steps", "um", ...
  std::optional<double> coarse_spacing;
  std::vector<ManifestEntry> entries;  ///< In any order; no picture twice.
  /// Lines that begin with # and are pictures if there are files of such names, else comments.
  std::vector<ManifestEntry> perhaps = {};
};

/// Reads a manifest; `name` stands in error messages. Throws Error(bad_data), with the line, for a
/// missing column, a position that is no finite number, a picture given twice, or no entries; and
/// for UTF-16.
Manifest parse_manifest(std::string_view text, const std::string& name);

/// The text that parse_manifest reads back to the same values, positions to the last bit. Without
/// entries it is a head that more can be written behind. Throws
/// Error(bad_argument) for what it would refuse, and for a line break in a name.
std::string manifest_text(const Manifest& manifest);

}  // namespace fathom
