// SPDX-License-Identifier: Apache-2.0
// How the lens of each rig blurs, kept between measurements: a small file a rig, so that the second
// measurement is quicker than the first.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "../focus/blur.hpp"
#include "rig.hpp"
#include "run.hpp"

namespace fathom {

/// A blur that pictures told.
struct LearnedBlur {
  BlurModel model;
  int pictures = 0;     ///< That it follows from.
  std::string learned;  ///< Date, ISO 8601; empty where nobody said it.

  bool operator==(const LearnedBlur&) const = default;
};

/// What a search or a sweep tells of the blur; nothing where it passes no focus, or its pictures do
/// not defocus as a lens makes them.
std::optional<LearnedBlur> blur_of(const Run& run);
/// Of several, what the one that is surest says.
std::optional<LearnedBlur> blur_of(std::span<const Run> runs);

/// What a lens's blur in px depends on: the rig's text without what is the target's or the light's,
/// a rig file by its place, the size of its pictures and the lens's unit.
std::string blur_key(Rig& rig);

/// The files of a folder, one for each key.
class BlurStore {
 public:
  explicit BlurStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// What is kept for a rig. Throws Error for a file that is there and cannot be read (io), is
  /// damaged, or of another rig (bad_data).
  std::optional<LearnedBlur> find(const std::string& key) const;

  /// Takes the place of what was there; a reader sees the one or the other. Throws Error(io).
  void keep(const std::string& key, const LearnedBlur& blur) const;

  std::filesystem::path path_of(const std::string& key) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace fathom
