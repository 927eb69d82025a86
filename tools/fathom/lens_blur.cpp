// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/lens_blur.hpp"

#include <fmt/format.h>

#include "engine/printable.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/run_keeping.hpp"
#include "words/warning_words.hpp"

namespace fathom::cli {
namespace {

std::optional<BlurStore> store() {
  const std::filesystem::path folder = state_folder();
  if (folder.empty()) return std::nullopt;
  return BlurStore(folder / "blur");
}

std::string words_for(const BlurNote& note, const std::string& unit) {
  const std::string blur = blur_words(note.px_per_unit, unit);
  switch (note.news) {
    case BlurNews::not_read:
      return fmt::format("what was learned of this lens's blur is not used: {}",
                         printable(note.text));
    case BlurNews::of_calibration:
      return fmt::format("blur of the lens: {}, from the calibration; --blur overrides", blur);
    case BlurNews::of_before:
      return fmt::format("blur of the lens: {}, learned {}; --blur overrides", blur,
                         printable(note.text));
    case BlurNews::learned:
      return fmt::format("blur of the lens learned: {}; the next search is quicker for it", blur);
    case BlurNews::learned_once:
      return fmt::format("blur of the lens learned: {}", blur);
    case BlurNews::not_kept:
      return fmt::format("the lens's blur is not kept: {}", printable(note.text));
  }
  return "";
}

}  // namespace

LensBlur lens_blur(Rig& rig, const FocusRequest& request, const Calibration* calibration) {
  const std::string unit = rig.lens().info().unit;
  return {
      rig,
      request,
      {.store = store(), .noted = [unit](const BlurNote& news) { note(words_for(news, unit)); }},
      calibration};
}

}  // namespace fathom::cli
