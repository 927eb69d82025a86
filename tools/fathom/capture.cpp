// SPDX-License-Identifier: Apache-2.0
// fathom capture: photograph every lens position into a folder that replay: reads.
#include <algorithm>
#include <filesystem>

#include "engine/error.hpp"
#include "engine/file.hpp"
#include "engine/windowed_metric.hpp"
#include "hal/drivers/replay/manifest.hpp"
#include "pictures/picture.hpp"
#include "session/session.hpp"
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/search_view.hpp"
#include "tools/fathom/verbs.hpp"
#include "tools/fathom/warning_words.hpp"

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

/// Writes a picture of every position, and after each the manifest of all, so that a run that ends
/// early leaves a folder that can be played.
class Pictures final : public Observer {
 public:
  Pictures(fs::path folder, const LensInfo& lens) : folder_(std::move(folder)) {
    manifest_.unit = lens.unit;
    manifest_.coarse_spacing = lens.coarse_spacing;
  }

  void frame(const Frame& frame, const Arrival& arrival, std::span<const double>) override {
    const std::string file = fmt::format("frame_{:05}.png", manifest_.entries.size());
    write_picture(folder_ / file, frame);
    manifest_.entries.push_back({file, arrival.position});
    write_file(folder_ / "manifest.csv", manifest_text(manifest_));
  }

 private:
  fs::path folder_;
  Manifest manifest_;
};

/// Any camera's pictures can be captured: of a small one the window is small.
std::string metric_for(Camera& camera) {
  const CameraSettings picture = camera.settings();
  int side = kDefaultWindowSide;
  while (side > kSmallestWindow && side > std::min(picture.width_px, picture.height_px)) side /= 2;
  return fmt::format("fft:{}", side);
}

Rig open(const Arguments& arguments) {
  RigOptions options;
  options.rig = arguments.rig;
  options.shot.average = checked_average(arguments.average);
  options.shot.stop_requests = stop_requests;
  Hardware hardware = open_hardware(arguments.rig, {.stop_requests = stop_requests});
  options.metric = metric_for(*hardware.camera);
  return Rig(options, std::move(hardware));
}

int run(const Arguments& arguments) {
  require_empty(arguments.output);
  Rig rig = open(arguments);
  const LensInfo lens = rig.lens().info();
  const fs::path folder = arguments.output;
  Pictures pictures(folder, lens);
  SweepView view("capture", false);
  WarningNotes notes;
  LensReturn put_back(rig.lens(), notes);
  Observers all({&pictures, &view, &notes});
  const Run run = Session(rig).sweep({arguments.from, arguments.to, arguments.step}, all);
  const auto& taken = run.measurements;
  print_line(fmt::format("{} frames from {:g} to {:g} {} in {}; try fathom focus --rig replay:{}",
                         taken.size(), taken.front().position, taken.back().position, lens.unit,
                         folder.string(), folder.string()));
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
