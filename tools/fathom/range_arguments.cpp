// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/range_arguments.hpp"

#include <fmt/format.h>

#include <utility>

#include "engine/error.hpp"
#include "tools/fathom/aiming.hpp"
#include "tools/fathom/plot.hpp"

namespace fathom::cli {
namespace {

/// Options of a search, which --all is not. Names those that were given.
std::string given_for_one(const RangeArguments& arguments) {
  const SearchArguments &search = arguments.search, none;
  const RigArguments &rig = arguments.rig, plain;
  const std::pair<const char*, bool> options[] = {
      {"--window", !rig.metric.window.empty()},
      {"--metric", rig.metric.metric != plain.metric.metric},
      {"--repeat", arguments.repeat != 1},
      {"--continuous", arguments.continuous},
      {"--count", arguments.count.has_value()},
      {"--plot", !arguments.plot.empty()},
      {"--search", search.search != none.search},
      {"--peak", search.peak != none.peak},
      {"--bracket", !search.bracket.empty()},
      {"--tolerance", search.tolerance.has_value()},
      {"--frames", search.frames.has_value()}};
  std::string given;
  for (const auto& [name, is_given] : options) {
    if (is_given) given += (given.empty() ? "" : ", ") + std::string(name);
  }
  return given;
}

/// What goes with --all, and what does not.
void require_all_sensible(const RangeArguments& arguments) {
  if (!arguments.all) {
    if (arguments.step || !arguments.csv.empty())
      throw Error(ErrorCode::bad_argument, "--step and --csv go with --all");
    if (arguments.calibration.empty()) {
      throw Error(ErrorCode::bad_argument,
                  "a distance needs a --calibration, which fathom calibrate makes; only --all does "
                  "without, and tells positions");
    }
    return;
  }
  const std::string given = given_for_one(arguments);
  if (given.empty()) return;
  throw Error(ErrorCode::bad_argument,
              fmt::format("--all sweeps the lens and lists every surface in the picture; leave out "
                          "what is for one of them: {}",
                          given));
}

void require_one_sensible(const RangeArguments& arguments) {
  if (arguments.repeat < 1) throw Error(ErrorCode::bad_argument, "--repeat takes 1 or more");
  if (arguments.count && !arguments.continuous)
    throw Error(ErrorCode::bad_argument, "--count goes with --continuous");
  if (arguments.continuous && (arguments.repeat > 1 || !arguments.plot.empty())) {
    throw Error(ErrorCode::bad_argument,
                "--continuous gives one distance after the other; leave --repeat and --plot out");
  }
}

}  // namespace

void RangeArguments::require_sensible() const {
  require_all_sensible(*this);
  if (!all) require_one_sensible(*this);
}

RangeAllRequest RangeArguments::request_for_all() const {
  return {.taking = {.rig = rig.rig,
                     .from = search.from,
                     .to = search.to,
                     .step = step,
                     .average = rig.average},
          .calibration = calibration,
          .extrapolate = extrapolate,
          .blur = search.request().blur,
          .backend = rig.metric.backend,
          .device = rig.metric.device,
          .output = rig.output,
          .csv = csv,
          .json = rig.json};
}

void RangeArguments::add_to(Verb& verb) {
  rig.add_to(verb, "File for the run (default: in ~/.local/state/fathom/runs)", true, kAimHelp);
  verb.add_option("--calibration", calibration, "What fathom calibrate made");
  verb.add_option("--repeat", repeat, "Focus runs whose mean position is used").shows_default();
  verb.add_flag("--continuous", continuous,
                "Follow a target that moves: one distance after the other, each looked for where "
                "the last one was, until Ctrl-C");
  verb.add_option("--count", count, "How many distances --continuous gives (default: until Ctrl-C)")
      .at_least_one();
  verb.add_flag("--extrapolate", extrapolate, "Allow a distance beyond those that were calibrated");
  verb.add_flag("--all", all,
                "Sweep the lens and list every surface in the picture, the nearest first; without "
                "--calibration their positions");
  verb.add_option("--step", step,
                  "Distance between the positions of --all (default: some hundred)");
  verb.add_option("--csv", csv, "File for the surfaces of --all");
  search.add_to(verb);
  verb.add_option("--plot", plot, kPlotHelp);
}

}  // namespace fathom::cli
