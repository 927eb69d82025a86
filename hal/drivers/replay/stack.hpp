// SPDX-License-Identifier: Apache-2.0
// A recorded stack of pictures, each with the lens position at which it was taken.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hal/drivers/replay/manifest.hpp"
#include "pictures/picture.hpp"

namespace fathom::replay {

/// Whether a stands before b in the order that people expect: pcb_2 before pcb_10.
bool natural_less(std::string_view a, std::string_view b);

/// The pictures of a folder or the pages of a TIFF, in order of position.
///
/// A folder with a manifest.csv holds what that lists. Without one it holds its pictures (files
/// ending in .png, .jpg, .jpeg, .tif, .tiff, .pgm, .ppm, .pnm) in natural order of their names, the
/// pages of a TIFF one by one, at positions 0, 1, 2, ... "frames".
class RecordedStack {
 public:
  /// Reads every picture's header. Throws Error(io), and Error(bad_data) for a folder without
  /// pictures, a bad manifest, a picture that is missing or damaged, or pictures of different sizes
  /// or depths.
  explicit RecordedStack(const std::filesystem::path& path);

  const std::string& unit() const { return unit_; }
  std::size_t size() const { return frames_.size(); }
  /// Of its frames, increasing.
  const std::vector<double>& positions() const { return positions_; }
  PictureShape shape() const { return shape_; }

  /// The smallest distance between two neighbours; 1 where there is only one frame.
  double resolution() const { return resolution_; }

  /// LensInfo::coarse_spacing: the manifest's, else wide enough for 128 samples and a multiple of
  /// the resolution.
  double coarse_spacing() const;

  /// Index of the frame at one of positions().
  std::size_t index_of(double position) const;

  /// One frame, which lives for as long as somebody holds it. Throws Error(io), Error(bad_data) for
  /// a damaged picture, naming it.
  std::shared_ptr<const Frame> frame(std::size_t index);

 private:
  struct Entry {
    std::filesystem::path file;
    std::size_t page = 0;
    double position = 0;
    int line = 0;  // of the manifest
  };

  void list_manifest(const std::filesystem::path& folder);
  void list_folder(const std::filesystem::path& folder);
  void list_pages(const std::filesystem::path& file);
  void check_headers(const std::filesystem::path& path);
  void find_resolution();
  PictureFile& file_of(const Entry& entry);

  std::string unit_ = "frames";
  std::optional<double> manifest_spacing_;
  std::vector<Entry> frames_;
  std::vector<double> positions_;
  PictureShape shape_;
  double resolution_ = 1;

  // A stack may be larger than the memory: one file is kept open, and the frames used last.
  std::optional<std::pair<std::filesystem::path, PictureFile>> open_file_;
  std::list<std::pair<std::size_t, std::shared_ptr<const Frame>>> cache_;
};

}  // namespace fathom::replay
