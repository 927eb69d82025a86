// SPDX-License-Identifier: Apache-2.0
// A folder that gets all of its new files at once, or keeps what it had.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace fathom::mapping {

/// Files are written into a hidden folder beside those that they will replace, and moved when all
/// are there. Where something fails before, the hidden folder goes and the others stay as they were.
class OutputFolder {
 public:
  /// Makes the folder, if it is not there. Throws Error(io) with the system's reason,
  /// Error(bad_argument) for a path that is something else.
  explicit OutputFolder(std::filesystem::path folder);
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  ~OutputFolder();

  /// Writes a file that move_in() will put in place. Several threads may do so. Throws Error(io).
  void write(const std::string& name, std::string_view bytes) const;
  /// Puts every file that was written where it belongs. Throws Error(io).
  void move_in();
  /// Where a file will be.
  std::filesystem::path path_of(const std::string& name) const { return folder_ / name; }

 private:
  std::filesystem::path folder_, hidden_;
  bool is_new_ = false;
};

}  // namespace fathom::mapping
