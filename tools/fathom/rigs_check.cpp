// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/rigs_check.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/error.hpp"
#include "focus/focus.hpp"
#include "session/backlash.hpp"
#include "session/saturation.hpp"
#include "session/settling.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/search_view.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {
namespace {

/// How long frames are watched after a move; doubled while they still change.
constexpr double kFirstWatch_ms = 750;
constexpr double kLongestWatch_ms = 12'000;

/// Where the focus curve falls, in half-widths from its top: a score there says best where the lens
/// is. A lens that has not quite arrived shows.
constexpr double kSlope = 0.8;
/// What a sweep round the focus covers to either side, in half-widths.
constexpr double kReach = 2;

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
  double frames_per_s = 0;
  FrameCounts counts;
  double repeat_scatter = 0;
  std::optional<Focus> focus;
  std::optional<Settling> settling;  ///< With the rig's own settings, from the lens at rest on.
  std::optional<Backlash> backlash;  ///< Likewise: what the lens leaves of its play.
  std::optional<double> settle_ms;   ///< From the motor's stop on, with no waiting by the lens.
  std::optional<Backlash> play;      ///< With nothing taken up by the lens.
};

void print(const CheckArguments& arguments, const std::string& line) {
  if (!arguments.json) print_line(line);
}

void check_camera(const CheckArguments& arguments, Rig& rig, Findings& findings) {
  constexpr int kFrames = 10;
  const CameraSettings picture = rig.camera().settings();
  print(arguments,
        fmt::format(
            "camera:    {}; {} x {} px, {} bit{}", rig.camera().description(), picture.width_px,
            picture.height_px, picture.depth == Depth::bits8 ? 8 : 16,
            picture.exposure_ms > 0 ? fmt::format(", exposure {:g} ms", picture.exposure_ms) : ""));
  findings.repeat_scatter = rig.repeat_scatter(rig.lens().position(), kFrames);
  const Frame first = take_frame(rig.camera(), 0, rig.options().shot);
  Frame last = first.clone();
  for (int i = 1; i < kFrames; ++i) last = take_frame(rig.camera(), 0, rig.options().shot);
  const double span_s =
      1e-9 * static_cast<double>(last.exposure.start_ns - first.exposure.start_ns);
  findings.frames_per_s = span_s > 0 ? (kFrames - 1) / span_s : 0;
  findings.counts = rig.camera().counts();
  if (!rig.camera().is_live())
    return print(arguments, "frames:    recorded, so they do not scatter");
  print(arguments,
        fmt::format("frames:    {:.1f} a second, {} lost, {} corrupt; a score repeats within "
                    "{:.2g} %; {:.2g} % of the window is saturated",
                    findings.frames_per_s, findings.counts.dropped, findings.counts.corrupt,
                    100 * findings.repeat_scatter, 100 * saturated_part(last, rig.window())));
}

void check_focus(const CheckArguments& arguments, Rig& rig, Findings& findings) {
  const LensInfo lens = rig.lens().info();
  print(arguments, fmt::format("lens:      {}; {:g} to {:g} {}, stands at {:g}", lens.description,
                               lens.lowest, lens.highest, lens.unit, rig.lens().position()));
  SearchView view("focus", lens.unit, false);
  Objective objective = rig.objective([](const Measurement&) {});
  objective.on_evaluation = [&](const Evaluation& evaluation) { view.show(evaluation); };
  const FocusLimits limits = resolve_limits({}, lens);
  findings.focus = search_focus(objective, limits, rig.spec(), findings.repeat_scatter);
  print(arguments, "focus:     " + describe(*findings.focus, lens.unit));
}

bool has_curve(const Findings& findings) {
  return findings.focus->result() == FocusResult::focused &&
         findings.focus->lobes[0].half_width > 0;
}

/// A place on the slope of the curve inside of the lens's travel, and the end of the travel that is
/// further away.
struct Slope {
  double place, far_end;
};
Slope slope_of(const Focus& focus, const LensInfo& lens) {
  const double aside = std::max(kSlope * focus.lobes[0].half_width, lens.resolution);
  const double above = focus.position() + aside;
  const double place = above <= lens.highest ? above : focus.position() - aside;
  return {place, place - lens.lowest > lens.highest - place ? lens.lowest : lens.highest};
}

/// What one move takes; still not at rest where frames change after the longest watch.
Settling settling_of(Rig& rig, double from, double to, double rest_ms) {
  Settling settling;
  for (double watch_ms = kFirstWatch_ms; watch_ms <= kLongestWatch_ms; watch_ms *= 2) {
    settling = measure_settling(rig, from, to, rest_ms, watch_ms);
    if (settling.is_at_rest) break;
  }
  return settling;
}

/// The longest of what a long and a short move take, from either side; nothing where frames still
/// change after the longest watch. What is no chance shows a second time.
std::optional<Settling> slowest_settling(Rig& rig, const Focus& focus, double rest_ms) {
  const LensInfo lens = rig.lens().info();
  const Slope slope = slope_of(focus, lens);
  const double near = 4 * focus.lobes[0].half_width;
  std::optional<Settling> slowest;
  for (const double from : {slope.far_end, std::max(slope.place - near, lens.lowest),
                            std::min(slope.place + near, lens.highest)}) {
    Settling settling = settling_of(rig, from, slope.place, rest_ms);
    if (settling.is_at_rest && settling.settled_ms > 0) {
      const Settling again = settling_of(rig, from, slope.place, rest_ms);
      if (again.is_at_rest && again.settled_ms < settling.settled_ms) settling = again;
    }
    if (!settling.is_at_rest) return std::nullopt;
    if (!slowest || settling.settled_ms > slowest->settled_ms) slowest = settling;
  }
  return slowest;
}

Backlash backlash_round(Rig& rig, const Focus& focus, double rest_ms) {
  const double reach =
      std::max(kReach * focus.lobes[0].half_width, 6 * rig.lens().info().resolution);
  return measure_backlash(rig, focus.position(), reach, focus.floor, rest_ms);
}

/// A rig whose lens neither waits nor takes up its play, but for what is said here.
Rig bare_rig(const CheckArguments& arguments, double settle_ms) {
  const RigOptions options = options_of(arguments);
  OpenOptions open;
  open.stop_requests = options.shot.stop_requests;
  open.lens_overrides = {{"settle_ms", fmt::format("{}", settle_ms)}, {"backlash", "0"}};
  return Rig(options, open_hardware(options.rig, open));
}

std::string describe(const Backlash& backlash, const std::string& unit) {
  return fmt::format("focus at {:.2f} +- {:.2f} going up, {:.2f} +- {:.2f} going down",
                     backlash.up.position, backlash.up.sigma, backlash.down.position,
                     backlash.down.sigma) +
         (backlash.is_certain() ? fmt::format(": {:.2f} +- {:.2f} {} of play", backlash.play(),
                                              backlash.sigma(), unit)
                                : ": no play to be seen");
}

void check_own_settings(const CheckArguments& arguments, Rig& rig, Findings& findings) {
  const std::string unit = rig.lens().info().unit;
  if (rig.camera().is_live()) {
    findings.settling = slowest_settling(rig, *findings.focus, 0);
    const auto& settling = findings.settling;
    const double waits_ms = [&] {
      const Arrival arrival = rig.lens().move_to(rig.lens().nearest(findings.focus->position()));
      return 1e-6 * static_cast<double>(arrival.settled_ns - arrival.stopped_ns);
    }();
    if (!settling) {
      print(arguments, "settling:  frames still change after " +
                           fmt::format("{:g} s", kLongestWatch_ms / 1000) +
                           "; does the target move, or the light change?");
    } else if (settling->settled_ms <= waits_ms) {
      print(arguments,
            fmt::format("settling:  as set, enough: the lens waits {:.0f} ms, and frames "
                        "exposed after that are at rest",
                        waits_ms));
    } else {
      print(arguments, fmt::format("settling:  as set, too short: the lens waits {:.0f} ms, frames "
                                   "change until {:.0f} ms",
                                   waits_ms, settling->settled_ms));
    }
  }
  findings.backlash = backlash_round(rig, *findings.focus, 0);
  print(arguments, "backlash:  as set: " + describe(*findings.backlash, unit));
}

void measure_bare(const CheckArguments& arguments, Findings& findings) {
  const Focus& focus = *findings.focus;
  {
    Rig rig = bare_rig(arguments, 0);
    LensReturn put_back(rig.lens(), note);
    const auto settling = slowest_settling(rig, focus, kFirstWatch_ms);
    if (!settling) return;
    // A frame's interval more: another time the frames fall differently.
    findings.settle_ms = std::ceil((settling->settled_ms + settling->interval_ms) / 10) * 10;
    print(arguments,
          fmt::format("settling:  measured: frames exposed {:.0f} ms after the motor's stop "
                      "are at rest; they come every {:.0f} ms",
                      settling->settled_ms, settling->interval_ms));
  }
  Rig rig = bare_rig(arguments, *findings.settle_ms);
  LensReturn put_back(rig.lens(), note);
  findings.play = backlash_round(rig, focus, 0);
  print(arguments, "backlash:  measured: " + describe(*findings.play, rig.lens().info().unit));
}

/// The widest spacing of which one sample at least lies on the upper half of the peak.
double coarse_suggestion(const Findings& findings, const LensInfo& lens) {
  const double width = 2 * findings.focus->lobes[0].half_width;
  return std::max(std::floor(width / lens.resolution) * lens.resolution, lens.resolution);
}

void print_suggestions(const CheckArguments& arguments, const Findings& findings,
                       const LensInfo& lens) {
  if (!findings.settle_ms || !findings.play) return;
  print(arguments, "suggested for the lens in the rig file:");
  print(arguments, fmt::format("  settle_ms = {:g}", *findings.settle_ms));
  print(arguments, fmt::format("  backlash = {:g}", findings.play->suggestion(lens.resolution)));
  print(arguments, fmt::format("  coarse = {:g}", coarse_suggestion(findings, lens)));
}

void print_json(const CheckArguments& arguments, const Findings& findings, const LensInfo& lens) {
  JsonLine line;
  line.add("rig", arguments.rig)
      .add("frames_per_s", findings.frames_per_s)
      .add("dropped", static_cast<std::size_t>(findings.counts.dropped))
      .add("corrupt", static_cast<std::size_t>(findings.counts.corrupt))
      .add("repeat_scatter", findings.repeat_scatter);
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
  add("coarse",
      has_curve(findings) ? std::optional(coarse_suggestion(findings, lens)) : std::nullopt);
  print_line(line.text());
}

}  // namespace

int check_rig(const CheckArguments& arguments) {
  Findings findings;
  std::optional<Rig> rig(std::in_place, options_of(arguments));
  const LensInfo lens = rig->lens().info();
  {
    LensReturn put_back(rig->lens(), note);
    check_camera(arguments, *rig, findings);
    check_focus(arguments, *rig, findings);
    if (has_curve(findings)) check_own_settings(arguments, *rig, findings);
  }
  if (has_curve(findings) && lens_driver_of(arguments.rig).has_lens_traits()) {
    rig.reset();  // the hardware is opened again with other settings
    measure_bare(arguments, findings);
  }
  if (arguments.json) print_json(arguments, findings, lens);
  print_suggestions(arguments, findings, lens);
  if (has_curve(findings)) return kDone;
  note(
      "without one clear focus, settling and backlash cannot be measured: point the camera at "
      "something with texture that fills the window, or choose another --window");
  return kNoFocus;
}

}  // namespace fathom::cli
