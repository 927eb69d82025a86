// SPDX-License-Identifier: Apache-2.0
// What a driver noticed when it opened, and a user should know: above all what a recording was
// taken to be. Values, not words, as all warnings are (session/warning.hpp).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace fathom {

/// A folder without a manifest: its pictures stand in the order of their names.
struct OrderOfNames {
  bool by_numbers = false;  ///< By the values of the numbers in them; else letter by letter.
  std::size_t files = 0;
  std::string first, last;
};

/// The numbers in the names leave some out.
struct MissingNumbers {
  std::size_t count = 0;
  std::string before, after;  ///< The names round the first gap.
};

/// Files of a folder that were not read.
struct SkippedFiles {
  /// So many of one ending.
  struct Kind {
    std::string
        name;  ///< The ending without its point, or "pipe", "socket", "device", "no ending".
    std::size_t count = 0;
  };
  std::vector<Kind> kinds;  ///< At least one.
};

/// Names that differ in their endings alone: two takes of one position, played as two.
struct NamesTwice {
  std::size_t count = 0;
  std::string first, second;  ///< The first two such names.
};

/// Pictures beside a manifest that it does not name; they are not played.
struct UnnamedPictures {
  std::size_t count = 0;
  std::string first;
};

/// Pages of a TIFF that are marked as previews, masks or smaller copies.
struct SkippedPreviews {
  std::string file;
  std::size_t count = 0;
};

/// Pages of a TIFF whose pixels are not all in it, as of an aborted recording.
struct DamagedPages {
  std::string file;
  std::size_t first = 0;  ///< Page number of the first one, from 0.
  std::size_t count = 0;
  std::size_t whole = 0;  ///< Pages that are played.
  std::string why;
};

/// One page of a TIFF with many samples a pixel, which are taken as pictures of their own.
struct SamplesAsPictures {
  std::string file;
  std::size_t samples = 0;
};

/// Which planes of a stack with channels, times or images are played.
struct ChosenPlanes {
  std::string file;
  std::size_t image = 0, images = 1;
  std::size_t channel = 0, channels = 1;
  std::string channel_name = {};  ///< Or empty.
  std::size_t time = 0, times = 1;
  std::size_t planes = 0;   ///< How many are played,
  std::size_t missing = 0;  ///< and how many the file promises and has not.
  std::optional<double> spacing_um = std::nullopt;
  std::string why =
      {};  ///< What is wrong with the first of those that are there in part; or empty.
};

/// The description that should tell what the pages of a TIFF are (OME-XML) cannot be read.
struct DamagedDescription {
  std::string file;
};

/// A colour picture whose light is nearly all of one colour that luma weighs little.
struct DrownedColour {
  char colour = 'b';  ///< 'r', 'g' or 'b'.
  double part = 0;    ///< Contrast of the grey picture over that colour's.
};

/// Several pictures at one position: each such group is averaged.
struct RepeatedPictures {
  std::size_t pictures = 0;
  std::size_t positions = 0;
};

/// What the library that reads a format says of a file.
struct LibraryWord {
  std::string file;
  std::string text;
};

/// A new kind goes into this list; whoever visits it without an answer for that does not compile.
using Finding =
    std::variant<OrderOfNames, MissingNumbers, SkippedFiles, NamesTwice, UnnamedPictures,
                 SkippedPreviews, DamagedPages, SamplesAsPictures, ChosenPlanes, DamagedDescription,
                 DrownedColour, RepeatedPictures, LibraryWord>;

}  // namespace fathom
