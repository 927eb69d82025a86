// SPDX-License-Identifier: Apache-2.0
#include "python/warning_values.hpp"

#include <fmt/ranges.h>
#include <pybind11/stl.h>

#include "python/terms.hpp"
#include "words/warning_words.hpp"

namespace fathom::python {
namespace {

namespace py = pybind11;

template <class... Values>
py::dict named(const char* kind, Values&&... values) {
  return py::dict(py::arg("kind") = kind, std::forward<Values>(values)...);
}

const char* name_of(PoorLight::Kind kind) {
  switch (kind) {
    case PoorLight::Kind::dark:
      return "dark";
    case PoorLight::Kind::bright:
      return "bright";
    case PoorLight::Kind::flickering:
      return "flickering";
  }
  return "";
}

const char* name_of(HaltsInstead::Why why) {
  switch (why) {
    case HaltsInstead::Why::unwatched:
      return "unwatched";
    case HaltsInstead::Why::not_by_spectra:
      return "not-by-spectra";
    case HaltsInstead::Why::too_quick:
      return "too-quick";
    case HaltsInstead::Why::unplaced:
      return "unplaced";
  }
  return "";
}

/// One function a kind: a new one without values does not compile.
struct FindingValues {
  py::dict operator()(const OrderOfNames& order) const {
    return named("order-of-names", py::arg("by_numbers") = order.by_numbers,
                 py::arg("files") = order.files, py::arg("first") = order.first,
                 py::arg("last") = order.last);
  }
  py::dict operator()(const MissingNumbers& gap) const {
    return named("missing-numbers", py::arg("count") = gap.count, py::arg("before") = gap.before,
                 py::arg("after") = gap.after);
  }
  py::dict operator()(const SkippedFiles& skipped) const {
    py::dict kinds;
    for (const SkippedFiles::Kind& kind : skipped.kinds) kinds[py::str(kind.name)] = kind.count;
    return named("skipped-files", py::arg("kinds") = kinds);
  }
  py::dict operator()(const NamesTwice& twice) const {
    return named("names-twice", py::arg("count") = twice.count, py::arg("first") = twice.first,
                 py::arg("second") = twice.second);
  }
  py::dict operator()(const UnnamedPictures& unnamed) const {
    return named("unnamed-pictures", py::arg("count") = unnamed.count,
                 py::arg("first") = unnamed.first);
  }
  py::dict operator()(const SkippedPreviews& skipped) const {
    return named("skipped-previews", py::arg("file") = skipped.file,
                 py::arg("count") = skipped.count);
  }
  py::dict operator()(const DamagedPages& damaged) const {
    return named("damaged-pages", py::arg("file") = damaged.file, py::arg("first") = damaged.first,
                 py::arg("count") = damaged.count, py::arg("whole") = damaged.whole,
                 py::arg("why") = damaged.why);
  }
  py::dict operator()(const SamplesAsPictures& samples) const {
    return named("samples-as-pictures", py::arg("file") = samples.file,
                 py::arg("samples") = samples.samples);
  }
  py::dict operator()(const ChosenPlanes& chosen) const {
    return named("chosen-planes", py::arg("file") = chosen.file, py::arg("image") = chosen.image,
                 py::arg("channel") = chosen.channel, py::arg("channel_name") = chosen.channel_name,
                 py::arg("time") = chosen.time, py::arg("planes") = chosen.planes,
                 py::arg("missing") = chosen.missing, py::arg("spacing_um") = chosen.spacing_um,
                 py::arg("why") = chosen.why);
  }
  py::dict operator()(const DamagedDescription& damaged) const {
    return named("damaged-description", py::arg("file") = damaged.file);
  }
  py::dict operator()(const DrownedColour& drowned) const {
    return named("drowned-colour", py::arg("colour") = std::string(1, drowned.colour),
                 py::arg("part") = drowned.part);
  }
  py::dict operator()(const RepeatedPictures& repeated) const {
    return named("repeated-pictures", py::arg("pictures") = repeated.pictures,
                 py::arg("positions") = repeated.positions);
  }
  py::dict operator()(const LibraryWord& word) const {
    return named("library-word", py::arg("file") = word.file, py::arg("text") = word.text);
  }
};

struct WarningValues {
  py::dict operator()(const InexactPositions& inexact) const {
    py::list places;
    for (const InexactPositions::Place& place : inexact.places)
      places.append(py::make_tuple(place.wanted, place.nearest));
    return named("inexact-positions", py::arg("places") = places, py::arg("unit") = inexact.unit);
  }
  py::dict operator()(const StepTooFine& fine) const {
    return named("step-too-fine", py::arg("step") = fine.step,
                 py::arg("resolution") = fine.resolution, py::arg("unit") = fine.unit);
  }
  py::dict operator()(const Saturation& saturation) const {
    return named("saturation", py::arg("part") = saturation.part,
                 py::arg("position") = saturation.position);
  }
  py::dict operator()(const LightChanged& light) const {
    return named("light-changed", py::arg("part") = light.part, py::arg("is_even") = light.is_even);
  }
  py::dict operator()(const NoiseChanged& noise) const {
    return named("noise-changed", py::arg("least") = noise.least, py::arg("most") = noise.most);
  }
  py::dict operator()(const Receding& receding) const {
    return named("receding", py::arg("first") = receding.from, py::arg("last") = receding.to,
                 py::arg("spread") = receding.spread, py::arg("unit") = receding.unit);
  }
  py::dict operator()(const LostFrames& lost) const {
    return named("lost-frames", py::arg("dropped") = lost.during.dropped,
                 py::arg("corrupt") = lost.during.corrupt,
                 py::arg("delivered") = lost.during.delivered);
  }
  py::dict operator()(const LensNote& note) const {
    return named("lens-note", py::arg("position") = note.position, py::arg("text") = note.text);
  }
  py::dict operator()(const LensNotReturned& lost) const {
    return named("lens-not-returned", py::arg("position") = lost.position,
                 py::arg("why") = lost.why);
  }
  py::dict operator()(const PoorLight& light) const {
    return named("poor-light", py::arg("how") = name_of(light.kind), py::arg("part") = light.part,
                 py::arg("exposure_ms") = light.exposure_ms);
  }
  py::dict operator()(const BlurDoubted& doubted) const {
    return named("blur-doubted", py::arg("used") = doubted.used, py::arg("seen") = doubted.seen,
                 py::arg("was_misled") = doubted.was_misled, py::arg("unit") = doubted.unit);
  }
  py::dict operator()(const FewOnTheWay& few) const {
    return named("few-on-the-way", py::arg("unplaced") = few.unplaced,
                 py::arg("smeared") = few.smeared, py::arg("visited") = few.visited);
  }
  py::dict operator()(const HaltsInstead& halts) const {
    return named("halts-instead", py::arg("why") = name_of(halts.why),
                 py::arg("lens_says") = halts.lens_says);
  }
  py::dict operator()(const Finding& finding) const { return std::visit(FindingValues{}, finding); }
};

}  // namespace

py::dict dict_of(const Warning& warning) {
  py::dict values = std::visit(WarningValues{}, warning);
  values["text"] = fmt::format("{}", fmt::join(lines_of(warning, kTerms), "; "));
  return values;
}

py::dict dict_of(const CalibrationDoubt& doubt) {
  return py::dict(py::arg("kind") = doubt.kind, py::arg("text") = doubt.text);
}

}  // namespace fathom::python
