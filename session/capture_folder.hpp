// SPDX-License-Identifier: Apache-2.0
// A folder that pictures are captured into: one capture at a time, and whatever ends it, what the
// manifest names is there and whole.
#pragma once

#include <filesystem>

#include "../engine/frame.hpp"
#include "../hal/drivers/replay/manifest.hpp"
#include "observer.hpp"

namespace fathom {

class CaptureFolder {
 public:
  /// Makes the folder if need be, takes it for this process alone and writes a manifest of no
  /// pictures: a folder without one would play its pictures by their numbers. Throws
  /// Error(bad_argument) for a folder that holds something, which is somebody's data,
  /// Error(unavailable) for one that another capture writes into, Error(io).
  explicit CaptureFolder(std::filesystem::path folder);
  CaptureFolder(const CaptureFolder&) = delete;
  CaptureFolder& operator=(const CaptureFolder&) = delete;
  /// Leaves nothing behind where no picture was kept.
  ~CaptureFolder();

  /// What the manifest says of the lens. Throws Error(io).
  void describe(const std::string& unit, double coarse_spacing);
  /// Throws Error(io); then the picture is not in the folder.
  void add(const Frame& picture, double position);
  std::size_t size() const { return manifest_.entries.size(); }

 private:
  void lock();
  void require_empty() const;
  void write_manifest() const;

  std::filesystem::path folder_;
  Manifest manifest_;
  bool is_new_ = false;  ///< The folder was made here.
  int lock_ = -1;        ///< The folder itself, open and locked.
};

/// Keeps a picture of every position in such a folder, which must outlive this.
class CapturedPictures final : public Observer {
 public:
  explicit CapturedPictures(CaptureFolder& folder) : folder_(folder) {}

  void frame(const Frame& frame, const Arrival& arrival, std::span<const double>) override {
    folder_.add(frame, arrival.position);
  }

 private:
  CaptureFolder& folder_;
};

}  // namespace fathom
