// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/rigs_check.hpp"

#include <optional>

#include "session/check.hpp"
#include "session/session.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/search_view.hpp"
#include "tools/fathom/verbs.hpp"
#include "tools/fathom/warning_words.hpp"

namespace fathom::cli {
namespace {

RigOptions options_of(const CheckArguments& arguments) {
  RigOptions options;
  options.rig = arguments.rig;
  options.metric = arguments.metric.metric;
  options.window = arguments.metric.chosen_window();
  options.backend = arguments.metric.backend;
  options.device = arguments.metric.device;
  options.shot.stop_requests = stop_requests;
  return options;
}

/// What is found out, in the order in which it is.
struct Findings {
  CameraCheck camera;
  std::optional<Focus> focus;
  std::optional<Settling> settling;  ///< With the rig's own settings, from the lens at rest on.
  std::optional<Backlash> backlash;  ///< Likewise: what the lens leaves of its play.
  std::optional<double> settle_ms;   ///< From the motor's stop on, with no waiting by the lens.
  std::optional<Backlash> play;      ///< With nothing taken up by the lens.
};

void print(const CheckArguments& arguments, const std::string& line) {
  if (!arguments.json) print_line(line);
}

void check_frames(const CheckArguments& arguments, Rig& rig, Findings& findings) {
  const CameraSettings picture = rig.camera().settings();
  print(arguments,
        fmt::format(
            "camera:    {}; {} x {} px, {} bit{}", rig.camera().description(), picture.width_px,
            picture.height_px, picture.depth == Depth::bits8 ? 8 : 16,
            picture.exposure_ms > 0 ? fmt::format(", exposure {:g} ms", picture.exposure_ms) : ""));
  const CameraCheck& camera = findings.camera = check_camera(rig);
  if (!rig.camera().is_live())
    return print(arguments, "frames:    recorded, so they do not scatter");
  print(arguments,
        fmt::format("frames:    {:.1f} a second, {} lost, {} corrupt; a score repeats within "
                    "{:.2g} %; {:.2g} % of the window is saturated",
                    camera.frames_per_s, camera.counts.dropped, camera.counts.corrupt,
                    100 * camera.repeat_scatter, 100 * camera.saturated));
}

void check_focus(const CheckArguments& arguments, Rig& rig, Findings& findings) {
  const LensInfo lens = rig.lens().info();
  print(arguments, fmt::format("lens:      {}; {:g} to {:g} {}, stands at {:g}", lens.description,
                               lens.lowest, lens.highest, lens.unit, rig.lens().position()));
  SearchView view("focus", lens.unit, false);
  WarningNotes notes;
  Observers all({&view, &notes});
  findings.focus = Session(rig).focus({}, all).focus;
  print(arguments, "focus:     " + describe(*findings.focus, lens.unit));
}

std::string describe(const Backlash& backlash, const std::string& unit) {
  return fmt::format("focus at {:.2f} +- {:.2f} going up, {:.2f} +- {:.2f} going down",
                     backlash.up.position, backlash.up.sigma, backlash.down.position,
                     backlash.down.sigma) +
         (backlash.is_certain() ? fmt::format(": {:.2f} +- {:.2f} {} of play", backlash.play(),
                                              backlash.sigma(), unit)
                                : ": no play to be seen");
}

std::string settling_words(const std::optional<Settling>& settling, double waits_ms) {
  if (!settling) {
    return fmt::format(
        "frames still change after {:g} s; does the target move, or the light change?",
        kLongestWatch_ms / 1000);
  }
  if (settling->settled_ms <= waits_ms) {
    return fmt::format(
        "as set, enough: the lens waits {:.0f} ms, and frames exposed after that are at rest",
        waits_ms);
  }
  return fmt::format("as set, too short: the lens waits {:.0f} ms, frames change until {:.0f} ms",
                     waits_ms, settling->settled_ms);
}

void check_own_settings(const CheckArguments& arguments, Rig& rig, Findings& findings) {
  const Focus& focus = *findings.focus;
  if (rig.camera().is_live()) {
    findings.settling = slowest_settling(rig, focus, 0);
    const double waits_ms = waiting_ms(rig, focus);
    print(arguments, "settling:  " + settling_words(findings.settling, waits_ms));
  }
  findings.backlash = backlash_round(rig, focus);
  print(arguments, "backlash:  as set: " + describe(*findings.backlash, rig.lens().info().unit));
}

void measure_bare(const CheckArguments& arguments, Findings& findings) {
  const RigOptions options = options_of(arguments);
  WarningNotes notes;
  {
    Rig rig = bare_rig(options, 0);
    LensReturn put_back(rig.lens(), notes);
    const auto settling = slowest_settling(rig, *findings.focus, kFirstWatch_ms);
    if (!settling) return;
    findings.settle_ms = suggested_settle_ms(*settling);
    print(arguments,
          fmt::format("settling:  measured: frames exposed {:.0f} ms after the motor's stop "
                      "are at rest; they come every {:.0f} ms",
                      settling->settled_ms, settling->interval_ms));
  }
  Rig rig = bare_rig(options, *findings.settle_ms);
  LensReturn put_back(rig.lens(), notes);
  findings.play = backlash_round(rig, *findings.focus);
  print(arguments, "backlash:  measured: " + describe(*findings.play, rig.lens().info().unit));
}

void print_suggestions(const CheckArguments& arguments, const Findings& findings,
                       const LensInfo& lens) {
  if (!findings.settle_ms || !findings.play) return;
  print(arguments, "suggested for the lens in the rig file:");
  print(arguments, fmt::format("  settle_ms = {:g}", *findings.settle_ms));
  print(arguments, fmt::format("  backlash = {:g}", findings.play->suggestion(lens.resolution)));
  print(arguments,
        fmt::format("  coarse = {:g}", suggested_coarse(*findings.focus, lens.resolution)));
}

void print_json(const CheckArguments& arguments, const Findings& findings, const LensInfo& lens) {
  JsonLine line;
  line.add("rig", arguments.rig)
      .add("frames_per_s", findings.camera.frames_per_s)
      .add("dropped", static_cast<std::size_t>(findings.camera.counts.dropped))
      .add("corrupt", static_cast<std::size_t>(findings.camera.counts.corrupt))
      .add("repeat_scatter", findings.camera.repeat_scatter);
  add_focus(line, *findings.focus, lens);
  const auto add = [&](const char* key, const std::optional<double>& value) {
    value ? line.add(key, *value) : line.add_null(key);
  };
  const auto play_of = [](const std::optional<Backlash>& backlash) {
    return backlash ? std::optional(backlash->play()) : std::nullopt;
  };
  add("settled_after_ms",
      findings.settling ? std::optional(findings.settling->settled_ms) : std::nullopt);
  add("play_left", play_of(findings.backlash));
  add("settle_ms", findings.settle_ms);
  add("play", play_of(findings.play));
  add("backlash",
      findings.play ? std::optional(findings.play->suggestion(lens.resolution)) : std::nullopt);
  add("coarse", has_curve(*findings.focus)
                    ? std::optional(suggested_coarse(*findings.focus, lens.resolution))
                    : std::nullopt);
  print_line(line.text());
}

}  // namespace

int check_rig(const CheckArguments& arguments) {
  Findings findings;
  std::optional<Rig> rig(std::in_place, options_of(arguments));
  const LensInfo lens = rig->lens().info();
  {
    WarningNotes notes;
    LensReturn put_back(rig->lens(), notes);
    check_frames(arguments, *rig, findings);
    check_focus(arguments, *rig, findings);
    if (has_curve(*findings.focus)) check_own_settings(arguments, *rig, findings);
  }
  if (has_curve(*findings.focus) && lens_driver_of(arguments.rig).has_lens_traits()) {
    rig.reset();  // the hardware is opened again with other settings
    measure_bare(arguments, findings);
  }
  if (arguments.json) print_json(arguments, findings, lens);
  print_suggestions(arguments, findings, lens);
  if (has_curve(*findings.focus)) return kDone;
  note(
      "without one clear focus, settling and backlash cannot be measured: point the camera at "
      "something with texture that fills the window, or choose another --window");
  return kNoFocus;
}

}  // namespace fathom::cli
