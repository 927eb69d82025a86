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

#include "hal/drivers/replay/listing.hpp"
#include "pictures/picture.hpp"

namespace fathom::replay {

/// The pictures of a folder or the pages of a TIFF, in order of position.
///
/// A folder with a manifest.csv holds what that lists. Without one it holds its pictures (files
/// ending in .png, .jpg, .jpeg, .tif, .tiff, .pgm, .ppm, .pnm) in the order of their names
/// (names.hpp), the pages of a TIFF one by one, at positions 0, 1, 2, ... "frames". Of a stack with
/// channels and times the slices of the chosen ones are played, in "um" where the file tells how
/// far apart they are.
class RecordedStack {
 public:
  /// Reads every picture's header. Throws Error(io), and Error(bad_data) for a folder without
  /// pictures, a bad manifest, a picture that is missing or damaged, or pictures of different sizes
  /// or depths; Error(bad_argument) where a channel, time or image must be chosen.
  explicit RecordedStack(const std::filesystem::path& path, const Wishes& wishes = {});

  const std::string& unit() const { return listing_.unit; }
  /// How many pictures there are.
  std::size_t size() const { return listing_.pictures.size(); }
  /// Of its pictures, increasing; each once.
  const std::vector<double>& positions() const { return positions_; }
  /// Which picture each of positions() is, or which are.
  const std::vector<std::string>& names() const { return names_; }
  PictureShape shape() const { return shape_; }
  /// What a user should know of it.
  const std::vector<Finding>& findings() const { return listing_.findings; }

  /// The smallest distance between two neighbours; 1 where there is only one position.
  double resolution() const { return resolution_; }

  /// LensInfo::coarse_spacing: the manifest's, else wide enough for 128 samples and a multiple of
  /// the resolution.
  double coarse_spacing() const;

  /// Index of one of positions().
  std::size_t index_of(double position) const;

  /// How many pictures were taken at one of positions(): 1 or more.
  std::size_t pictures_at(std::size_t index) const { return first_[index + 1] - first_[index]; }

  /// One of them, which lives for as long as somebody holds it. Throws Error(io), Error(bad_data)
  /// for a damaged picture, naming it.
  std::shared_ptr<const Frame> frame(std::size_t index, std::size_t which = 0);

  /// The same, and its colours beside it (pictures/picture.hpp); nothing of it is kept.
  Frame read(std::size_t index, std::size_t which, Colours& colours);
  /// Whether its pictures are of colours. Throws likewise.
  bool is_colour();

 private:
  void check_headers(const std::filesystem::path& path);
  void group();
  void look_for_drowned_colour();
  void require_shape(const ListedPicture& entry, const Frame& frame) const;
  static std::string label(const ListedPicture& picture);
  PictureFile& file_of(const ListedPicture& entry);

  Listing listing_;
  std::vector<double> positions_;
  std::vector<std::size_t> first_;  // picture of each position, and the end
  std::vector<std::string> names_;
  PictureShape shape_;
  double resolution_ = 1;

  // A stack may be larger than the memory: one file is kept open, and the frames used last.
  std::optional<std::pair<std::filesystem::path, PictureFile>> open_file_;
  std::list<std::pair<std::size_t, std::shared_ptr<const Frame>>> cache_;
};

/// The recording that open_hardware() would play for this rig text or rig file; nothing where the
/// rig is no recording. Throws as open_hardware() and RecordedStack do.
std::optional<RecordedStack> open_recording(std::string_view rig);

}  // namespace fathom::replay
