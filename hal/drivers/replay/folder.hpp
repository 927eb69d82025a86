// SPDX-License-Identifier: Apache-2.0
// What lies in a folder of pictures.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace fathom::replay {

/// The files of a folder, without hidden ones and folders in it.
struct Folder {
  std::vector<std::string> pictures;  ///< Names with a picture's ending, in any order.
  std::map<std::string, std::size_t>
      skipped;  ///< Of each other kind (SkippedFiles::Kind) how many.
};

/// Opens no file of it. Throws Error(io) with the system's reason.
Folder read_folder(const std::filesystem::path& path);

}  // namespace fathom::replay
