// SPDX-License-Identifier: Apache-2.0
// Stacks with channels and times: which of their planes are played.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hal/finding.hpp"
#include "pictures/picture.hpp"

namespace fathom::replay {

/// What a rig text asks of a recording beyond its path.
struct Wishes {
  std::string channel;               ///< A number from 0, a channel's name, or a colour; or empty.
  std::optional<std::size_t> time;   ///< From 0.
  std::optional<std::size_t> image;  ///< From 0, of a file that holds several.
  double scale = 0;                  ///< PictureOptions::scale.
};

/// r, g, b, red, green or blue.
std::optional<Colour> colour_named(const std::string& word);

/// A plane's place on the disk.
struct Place {
  std::filesystem::path file;
  std::size_t page = PictureStack::kMissing;
};

/// A stack whose planes may lie in several files.
struct SpreadStack {
  std::filesystem::path file;  ///< The first one.
  std::vector<PictureStack> images;
  std::vector<std::vector<Place>> places;  ///< Of each image, in the order of PictureStack::pages.
};

SpreadStack spread_over(const std::filesystem::path& file, const PictureContents& contents);

/// Whether the stacks say the same and have no plane in common: files of one recording.
bool belong_together(const std::vector<SpreadStack>& stacks);
SpreadStack joined(std::vector<SpreadStack> stacks);

/// The planes that are played.
struct ChosenStack {
  struct Plane {
    Place place;
    std::size_t number = 0;  ///< Slice, or time where there is one slice alone.
  };
  std::vector<Plane> planes;  ///< Those that are there.
  bool plays_times = false;   ///< A travel that was recorded as a film: one slice, many times.
  ChosenPlanes choice = {};
};

/// played: the file or folder that was asked for, for the advice. Throws Error(bad_argument) where a
/// channel, time or image must be chosen, saying which there are, or does not exist; Error(bad_data)
/// where the file has none of the planes.
ChosenStack choose(const SpreadStack& stack, const Wishes& wishes,
                   const std::filesystem::path& played);

}  // namespace fathom::replay
