// SPDX-License-Identifier: Apache-2.0
// fathom capture: photograph every lens position into a folder that replay: reads.
#include "engine/error.hpp"
#include "engine/printable.hpp"
#include "session/capture_folder.hpp"
#include "session/session.hpp"
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/picture_rig.hpp"
#include "tools/fathom/search_view.hpp"
#include "tools/fathom/verbs.hpp"
#include "tools/fathom/warning_notes.hpp"

namespace fathom::cli {
namespace {

struct Arguments {
  std::string rig;
  std::optional<double> from, to, step;
  int average = 1;
  std::string output;
};

std::string folder_words(const std::string& folder) {
  return fmt::format("in {}; try fathom focus --rig replay:{}", printable(folder),
                     printable(folder));
}

Run sweep(Rig& rig, const Arguments& arguments, CaptureFolder& folder) {
  CapturedPictures pictures(folder);
  SweepView view("capture", rig.lens().info(), false);
  WarningNotes notes;
  LensReturn put_back(rig.lens(), notes);
  Observers all({&pictures, &view, &notes});
  return Session(rig).sweep({arguments.from, arguments.to, checked_step(arguments.step)}, all);
}

int run(const Arguments& arguments) {
  CaptureFolder folder(arguments.output);
  Rig rig = open_picture_rig(arguments.rig, arguments.average);
  const LensInfo lens = rig.lens().info();
  folder.describe(lens.unit, lens.coarse_spacing);
  try {
    const auto taken = sweep(rig, arguments, folder).measurements;
    print_line(fmt::format("{} frames from {:g} to {:g} {} {}", taken.size(),
                           taken.front().position, taken.back().position, lens.unit,
                           folder_words(arguments.output)));
  } catch (const OutputError&) {
    throw;
  } catch (const Error& error) {
    if (folder.size() == 0) throw;
    throw Error(error.code(),
                fmt::format("{}; the {} frames taken before are whole, {}", error.what(),
                            folder.size(), folder_words(arguments.output)));
  }
  return kDone;
}

}  // namespace

void add_capture(Verb& program) {
  Verb verb =
      program.add_verb("capture", "Photograph lens positions into a folder that replay: reads");
  verb.set_footer(
      "Example:\n  fathom capture --rig sim:distance=1500 --from 800 --to 1100 --step 10 -o stack");
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
