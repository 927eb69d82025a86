// SPDX-License-Identifier: Apache-2.0
// fathom record: photograph every lens position into a folder that replay: reads.
#include <filesystem>

#include "engine/error.hpp"
#include "engine/file.hpp"
#include "focus/focus.hpp"
#include "hal/drivers/replay/manifest.hpp"
#include "pictures/picture.hpp"
#include "session/shot.hpp"
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/run_keeping.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string rig;
  std::optional<double> from, to, step;
  int average = 1;
  std::string output;
};

/// A folder that holds something is somebody's data; nothing is ever written over it.
void require_empty(const fs::path& folder) {
  std::error_code problem;
  if (fs::exists(folder, problem) &&
      (!fs::is_directory(folder, problem) || !fs::is_empty(folder, problem))) {
    throw Error(
        ErrorCode::bad_argument,
        fmt::format("{} exists and is not an empty folder; name a new one", folder.string()));
  }
}

int run(const Arguments& arguments) {
  require_empty(arguments.output);
  ShotOptions options;
  options.average = arguments.average;
  options.stop_requests = stop_requests;
  const Hardware rig = open_hardware(arguments.rig, {.stop_requests = stop_requests});
  const LensInfo lens = rig.lens->info();
  const FocusLimits limits =
      resolve_limits(FocusRequest::within(arguments.from, arguments.to), lens);
  const auto positions = arguments.step
                             ? sweep_positions(lens, limits.from, limits.to, *arguments.step)
                             : sweep_positions(lens, limits.from, limits.to);
  note_inexact_positions(*rig.lens, positions);
  LensReturn put_back(*rig.lens, note);
  Progress progress;
  Manifest manifest;
  manifest.unit = lens.unit;
  manifest.coarse_spacing = lens.coarse_spacing;
  const fs::path folder = arguments.output;
  for (const double position : positions) {
    const Shot shot = shoot(*rig.camera, *rig.lens, position, options);
    const std::string file = fmt::format("frame_{:05}.png", manifest.entries.size());
    write_picture(folder / file, shot.frame);
    manifest.entries.push_back({file, shot.arrival.position});
    // After every picture, so that a run that ends early leaves a folder that replays.
    write_file(folder / "manifest.csv", manifest_text(manifest));
    progress.bar("record", manifest.entries.size(), positions.size());
  }
  print_line(fmt::format("{} frames from {:g} to {:g} {} in {}; try fathom focus --rig replay:{}",
                         positions.size(), positions.front(), positions.back(), lens.unit,
                         folder.string(), folder.string()));
  return kDone;
}

}  // namespace

void add_record(Verb& program) {
  Verb verb =
      program.add_verb("record", "Photograph lens positions into a folder that replay: reads");
  verb.set_footer(
      "Example:\n  fathom record --rig sim:distance=1500 --from 800 --to 1100 --step 10 -o stack");
  auto arguments = std::make_shared<Arguments>();
  add_rig_option(verb, arguments->rig, true);
  verb.add_option("--from", arguments->from, "First lens position (default: the lens's lowest)");
  verb.add_option("--to", arguments->to, "Last lens position (default: the lens's highest)");
  verb.add_option("--step", arguments->step,
                  "Distance between positions (default: all recorded, or some hundred)");
  verb.add_option("--average", arguments->average, "Frames averaged for one picture")
      .shows_default();
  verb.add_option("-o,--output", arguments->output, "Folder to make").required();
  verb.on_run([arguments] { return run(*arguments); });
}

}  // namespace fathom::cli
