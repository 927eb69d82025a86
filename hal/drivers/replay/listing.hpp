// SPDX-License-Identifier: Apache-2.0
// Which pictures a recording has, at which positions, and what was noticed on the way.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hal/drivers/replay/planes.hpp"
#include "hal/finding.hpp"
#include "pictures/picture.hpp"

namespace fathom::replay {

struct ListedPicture {
  std::filesystem::path file;
  std::size_t page = 0;
  double position = 0;
  std::string name;  ///< For people: "pcb_012.png", "stack.tif page 12".
  int line = 0;      ///< Of the manifest, or 0.
};

struct Listing {
  std::string unit = "frames";
  std::optional<double> coarse_spacing;
  PictureOptions options;               ///< How the pictures are to be read.
  std::vector<ListedPicture> pictures;  ///< In any order; at least one.
  std::vector<Finding> findings;
};

/// Lists a folder (with or without a manifest), a TIFF or one picture. Opens every file that it
/// lists, and never a pipe, a socket or a device. Throws as RecordedStack does.
Listing list_recording(const std::filesystem::path& path, const Wishes& wishes);

}  // namespace fathom::replay
