// SPDX-License-Identifier: Apache-2.0
#include "words/finding_words.hpp"

#include <fmt/format.h>

namespace fathom {
namespace {

std::string counted(std::size_t count, const char* thing) {
  return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

/// One function a kind: a new one without words does not compile.
struct Words {
  std::string operator()(const OrderOfNames& order) const {
    return fmt::format(
        "no manifest.csv: {} pictures in the order of their names, {}, from {} to {}", order.files,
        order.by_numbers ? "by the numbers in them" : "letter by letter", order.first, order.last);
  }

  std::string operator()(const MissingNumbers& gap) const {
    return fmt::format(
        "{} missing in the names, first between {} and {}; positions count on without a gap, so "
        "give them in a manifest.csv if they matter",
        gap.count == 1 ? "a number is" : fmt::format("{} numbers are", gap.count), gap.before,
        gap.after);
  }

  std::string operator()(const SkippedFiles& skipped) const {
    std::size_t count = 0;
    std::string kinds;
    for (const SkippedFiles::Kind& kind : skipped.kinds) {
      count += kind.count;
      if (!kinds.empty()) kinds += ", ";
      kinds += skipped.kinds.size() == 1 ? kind.name : fmt::format("{} {}", kind.count, kind.name);
    }
    return fmt::format("{} skipped: {}; pictures are png, jpg, tif and pgm files",
                       counted(count, "file"), kinds);
  }

  std::string operator()(const NamesTwice& twice) const {
    return fmt::format(
        "{} there twice, with another ending, such as {} and {}: each is played at a position of "
        "its own; keep one of the two, or give positions in a manifest.csv",
        twice.count == 1 ? "a name is" : fmt::format("{} names are", twice.count), twice.first,
        twice.second);
  }

  std::string operator()(const UnnamedPictures& unnamed) const {
    return fmt::format("{} not named in manifest.csv, and not played, such as {}",
                       unnamed.count == 1
                           ? "a picture in the folder is"
                           : fmt::format("{} pictures in the folder are", unnamed.count),
                       unnamed.first);
  }

  std::string operator()(const SkippedPreviews& skipped) const {
    return fmt::format(
        "{}: {} marked as previews or masks, and skipped", skipped.file,
        skipped.count == 1 ? "a page is" : fmt::format("{} pages are", skipped.count));
  }

  std::string operator()(const DamagedPages& damaged) const {
    return fmt::format("{}: page {}{} cannot be read: {}; {} played", damaged.file, damaged.first,
                       damaged.count == 1 ? "" : fmt::format(" and {} more", damaged.count - 1),
                       damaged.why,
                       damaged.whole == 1 ? "one whole page is"
                                          : fmt::format("{} whole pages are", damaged.whole));
  }

  std::string operator()(const SamplesAsPictures& samples) const {
    return fmt::format(
        "{}: each pixel has {} samples that are no colours; each sample is taken as "
        "a picture of its own",
        samples.file, samples.samples);
  }

  std::string operator()(const ChosenPlanes& chosen) const {
    std::string text = fmt::format("{}: {}", chosen.file, counted(chosen.planes, "plane"));
    if (chosen.images > 1) text += fmt::format(", image {} of {}", chosen.image, chosen.images);
    if (chosen.channels > 1) {
      text +=
          fmt::format(", channel {}{} of {}", chosen.channel,
                      chosen.channel_name.empty() ? "" : fmt::format(" ({})", chosen.channel_name),
                      chosen.channels);
    }
    if (chosen.times > 1) text += fmt::format(", time {} of {}", chosen.time, chosen.times);
    if (chosen.spacing_um) text += fmt::format(", {:g} um apart", *chosen.spacing_um);
    if (chosen.missing > 0) {
      text += fmt::format("; {} more {} promised and not there{}", chosen.missing,
                          chosen.missing == 1 ? "is" : "are",
                          chosen.why.empty() ? "" : fmt::format(" ({})", chosen.why));
    }
    return text;
  }

  std::string operator()(const DamagedDescription& damaged) const {
    return fmt::format(
        "{}: its OME-XML is cut off or damaged, so channels, times and distances are not known; "
        "the pages are taken one after the other",
        damaged.file);
  }

  std::string operator()(const DrownedColour& drowned) const {
    return fmt::format(
        "the pictures are colours, and their grey has {:.0f} % of the contrast of one colour; "
        "channel={} plays that one",
        100 * drowned.part, drowned.colour);
  }

  std::string operator()(const RepeatedPictures& repeated) const {
    return fmt::format(
        "{} pictures at {} positions: those of a position are averaged, and how they scatter is "
        "how far a score repeats",
        repeated.pictures, repeated.positions);
  }

  std::string operator()(const LibraryWord& word) const {
    return fmt::format("{}: libtiff says: {}", word.file, word.text);
  }
};

}  // namespace

std::string words_for(const Finding& finding) { return std::visit(Words{}, finding); }

}  // namespace fathom
