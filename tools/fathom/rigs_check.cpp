// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/rigs_check.hpp"

#include <algorithm>
#include <optional>
#include <sstream>

#include "engine/error.hpp"
#include "session/check.hpp"
#include "session/session.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/rig_file.hpp"
#include "tools/fathom/search_view.hpp"
#include "tools/fathom/verbs.hpp"
#include "tools/fathom/warning_notes.hpp"

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
  std::optional<Hill> hill;          ///< What settling and backlash are measured on,
  std::optional<Aim> aim;            ///< and what it was seen with, if not as asked for.
  std::optional<Lag> lag;            ///< With the rig's own settings.
  std::optional<Backlash> backlash;  ///< Likewise: what the lens leaves of its play.
  std::optional<Lag> bare_lag;       ///< From the motor's stop on, with no waiting by the lens.
  std::optional<Backlash> play;      ///< With nothing taken up by the lens.
  double waits_ms = 0;               ///< How long the lens waits after the motor's stop, as set.
  std::optional<Focus> again;  ///< A search with what is suggested, where the first one failed.
};

std::optional<LensSettings> suggestion_of(const Findings& findings, const LensInfo& lens) {
  if (!findings.bare_lag || !findings.play) return std::nullopt;
  return LensSettings{suggested_settle_ms(*findings.bare_lag, lens),
                      findings.play->suggestion(lens.resolution),
                      suggested_coarse(*findings.hill, lens.resolution)};
}

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
  SearchView view("focus", lens.unit, false);
  WarningNotes notes;
  Observers all({&view, &notes});
  findings.focus = Session(rig).focus({}, all).focus;
  print(arguments, "focus:     " + describe(*findings.focus, lens.unit));
}

std::string play_words(const Backlash& backlash, const std::string& unit) {
  return fmt::format("focus at {:.2f} +- {:.2f} going up, {:.2f} +- {:.2f} going down",
                     backlash.up.position, backlash.up.sigma, backlash.down.position,
                     backlash.down.sigma) +
         (backlash.is_certain() ? fmt::format(": {:.2f} +- {:.2f} {} of play", backlash.play(),
                                              backlash.sigma(), unit)
                                : ": no play to be seen");
}

/// Says beforehand what will take long.
WatchNews watch_news(const CheckArguments& arguments) {
  constexpr double kLong_ms = 4000;
  return [&arguments](double from, double to, double takes_ms) {
    if (takes_ms < kLong_ms) return;
    print(arguments, fmt::format("           watching the way from {:g} to {:g} for {:.0f} s", from,
                                 to, takes_ms / 1000));
  };
}

std::string settling_words(const std::optional<Lag>& lag, double waits_ms) {
  if (!lag) {
    return fmt::format(
        "frames still change after {:g} s; does the target move, or the light change?",
        kLongestWatch_ms / 1000);
  }
  const double settled_ms = lag->slowest.settled_ms;
  if (settled_ms <= waits_ms) {
    return fmt::format(
        "as set, enough: the lens waits {:.0f} ms, and frames exposed after that are at rest",
        waits_ms);
  }
  return fmt::format("as set, too short: the lens waits {:.0f} ms, frames change until {:.0f} ms",
                     waits_ms, settled_ms);
}

/// Seen going upward: as the search says, if that holds, else by looking over the whole travel, and
/// with other metrics and windows if those asked for show nothing.
void look_for_hill(const CheckArguments& arguments, Rig& rig, Findings& findings) {
  if (has_curve(*findings.focus)) findings.hill = see_again(rig, hill_of(*findings.focus));
  if (findings.hill) return;
  print(arguments,
        "           looking again, going upward alone, with other metrics and windows; this takes "
        "some minutes where the lens or the camera is slow");
  const std::vector<Aim> aims = aims_to_try(rig);
  const std::optional<SeenHill> sighting = find_hill(rig, aims);
  if (!sighting) return;
  findings.hill = sighting->hill;
  const Aim& aim = sighting->aim;
  const bool is_own = aim.metric == rig.spec() && aim.window == rig.window();
  if (!is_own) findings.aim = aim;
  print(arguments, fmt::format("focus:     going upward, near {:.6g} {}{}", sighting->hill.position,
                               rig.lens().info().unit,
                               is_own ? ""
                                      : fmt::format(", with --metric {} --window {}",
                                                    aim.metric.text(), to_string(aim.window))));
}

/// The backlash, or a line that says why there is none to be told.
std::optional<Backlash> backlash_of(const CheckArguments& arguments, Rig& rig, const Hill& hill,
                                    const RestAfter& rest_ms, const std::string& how) {
  try {
    const Backlash backlash = measure_backlash(rig, hill, rest_ms);
    print(arguments,
          fmt::format("backlash:  {}: {}", how, play_words(backlash, rig.lens().info().unit)));
    return backlash;
  } catch (const Error& error) {
    if (error.code() != ErrorCode::bad_data) throw;
    print(arguments, fmt::format("backlash:  {}: {}", how, error.what()));
    return std::nullopt;
  }
}

void check_own_settings(const CheckArguments& arguments, Rig& rig, Findings& findings) {
  const Hill& hill = *findings.hill;
  double waits_ms = 0;
  if (rig.camera().is_live()) {
    findings.lag = measure_lag(rig, hill, watch_news(arguments));
    waits_ms = findings.waits_ms = waiting_ms(rig, hill);
    print(arguments, "settling:  " + settling_words(findings.lag, waits_ms));
  }
  const Lag lag = findings.lag.value_or(Lag());
  findings.backlash = backlash_of(
      arguments, rig, hill,
      [&](double distance) { return std::max(lag.after(distance) - waits_ms, 0.0); }, "as set");
}

/// Whether the rig's own settings are none: then what was measured with them is what there is.
bool is_bare(const CheckArguments& arguments, const Findings& findings) {
  constexpr double kNothing_ms = 1;  // what it takes to ask a clock is no waiting
  return findings.lag && findings.backlash && findings.waits_ms < kNothing_ms &&
         !lens_has_key(arguments.rig, "backlash");
}

void tell_lag(const CheckArguments& arguments, const Lag& lag, const LensInfo& lens) {
  print(arguments,
        fmt::format("settling:  measured: frames exposed {:.0f} ms after the motor's stop are at "
                    "rest; they come every {:.0f} ms",
                    lag.slowest.settled_ms, lag.slowest.interval_ms));
  if (lag.per_unit_ms == 0) return;
  print(arguments, fmt::format("           the farther, the longer: the driver says that the lens "
                               "is there while it still moves; {:.0f} ms for the whole travel",
                               lag.after(lens.highest - lens.lowest)));
}

void measure_bare(const CheckArguments& arguments, const RigOptions& options, const LensInfo& lens,
                  Findings& findings) {
  if (is_bare(arguments, findings)) {
    findings.bare_lag = findings.lag;
    findings.play = findings.backlash;
    return tell_lag(arguments, *findings.lag, lens);
  }
  WarningNotes notes;
  Rig rig = rig_with(options, {});  // the hardware is opened again
  LensReturn put_back(rig.lens(), notes);
  const auto lag = findings.bare_lag = measure_lag(rig, *findings.hill, watch_news(arguments));
  if (!lag) return;
  tell_lag(arguments, *lag, lens);
  const double interval_ms = lag->slowest.interval_ms;
  findings.play = backlash_of(
      arguments, rig, *findings.hill,
      [&](double distance) { return lag->after(distance) + interval_ms; }, "measured");
}

/// A search takes some fifty moves, and nobody wants to wait for hours.
constexpr double kTooSlow_ms = 1500;

/// What the first search did not find, one with the suggested values should.
void search_again(const CheckArguments& arguments, const RigOptions& options,
                  const LensSettings& suggestion, Findings& findings) {
  WarningNotes notes;
  Rig rig = rig_with(options, suggestion);
  LensReturn put_back(rig.lens(), notes);
  SearchView view("focus", rig.lens().info().unit, false);
  Observers all({&view, &notes});
  findings.again = Session(rig).focus({}, all).focus;
  print(arguments, "focus:     with these: " + describe(*findings.again, rig.lens().info().unit));
}

void print_suggestion(const CheckArguments& arguments, const LensSettings& suggestion) {
  print(arguments, "suggested, as a rig file that is ready to use; save it as my-rig.toml:");
  print(arguments, "");
  std::istringstream lines(rig_file_text(arguments.rig, suggestion));
  for (std::string line; std::getline(lines, line);) print(arguments, line);
  print(arguments, "");
}

void print_json(const CheckArguments& arguments, const Findings& findings, const LensInfo& lens) {
  JsonLine line;
  line.add("rig", arguments.rig)
      .add("frames_per_s", findings.camera.frames_per_s)
      .add("dropped", static_cast<std::size_t>(findings.camera.counts.dropped))
      .add("corrupt", static_cast<std::size_t>(findings.camera.counts.corrupt))
      .add("repeat_scatter", findings.camera.repeat_scatter);
  add_focus(line, findings.again ? *findings.again : *findings.focus, lens);
  const auto add = [&](const char* key, const std::optional<double>& value) {
    value ? line.add(key, *value) : line.add_null(key);
  };
  const auto play_of = [](const std::optional<Backlash>& backlash) {
    return backlash ? std::optional(backlash->play()) : std::nullopt;
  };
  const auto suggestion = suggestion_of(findings, lens);
  add("settled_after_ms",
      findings.lag ? std::optional(findings.lag->slowest.settled_ms) : std::nullopt);
  add("play_left", play_of(findings.backlash));
  add("settle_ms", suggestion ? std::optional(suggestion->settle_ms) : std::nullopt);
  add("play", play_of(findings.play));
  add("play_sigma", findings.play ? std::optional(findings.play->sigma()) : std::nullopt);
  add("backlash", suggestion ? std::optional(suggestion->backlash) : std::nullopt);
  add("coarse", findings.hill ? std::optional(suggested_coarse(*findings.hill, lens.resolution))
                              : std::nullopt);
  suggestion ? line.add("rig_file", rig_file_text(arguments.rig, suggestion))
             : line.add_null("rig_file");
  if (findings.aim) {
    line.add("metric_tried", findings.aim->metric.text())
        .add("window_tried", to_string(findings.aim->window));
  }
  print_line(line.text());
}

/// What is to be measured on: the rig as asked for, or with the aim that shows a focus.
RigOptions aimed(RigOptions options, const Findings& findings) {
  if (!findings.aim) return options;
  options.metric = findings.aim->metric.text();
  options.window = findings.aim->window;
  return options;
}

/// Everything for which the rig is left with its own settings.
LensInfo check_as_set(const CheckArguments& arguments, Findings& findings) {
  WarningNotes notes;
  const RigOptions options = options_of(arguments);
  std::optional<Rig> rig(std::in_place, options);
  LensInfo lens = rig->lens().info();
  {
    LensReturn put_back(rig->lens(), notes);
    check_frames(arguments, *rig, findings);
    print(arguments, fmt::format("lens:      {}; {:g} to {:g} {}, stands at {:g}", lens.description,
                                 lens.lowest, lens.highest, lens.unit, rig->lens().position()));
    check_focus(arguments, *rig, findings);
    if (lens_driver_of(arguments.rig).has_lens_traits() || !has_curve(*findings.focus)) {
      look_for_hill(arguments, *rig, findings);
    } else {
      findings.hill = hill_of(*findings.focus);
    }
    if (findings.hill && !findings.aim) check_own_settings(arguments, *rig, findings);
  }
  if (!findings.aim) return lens;
  rig.reset();
  rig.emplace(aimed(options, findings));
  LensReturn put_back(rig->lens(), notes);
  check_focus(arguments, *rig, findings);
  check_own_settings(arguments, *rig, findings);
  return lens;
}

}  // namespace

int check_rig(const CheckArguments& arguments) {
  Findings findings;
  const LensInfo lens = check_as_set(arguments, findings);
  const RigOptions options = aimed(options_of(arguments), findings);
  if (findings.hill && lens_driver_of(arguments.rig).has_lens_traits())
    measure_bare(arguments, options, lens, findings);
  const auto suggestion = suggestion_of(findings, lens);
  if (suggestion) print_suggestion(arguments, *suggestion);
  const bool is_quick = suggestion && suggestion->settle_ms <= kTooSlow_ms;
  if (is_quick && !has_curve(*findings.focus))
    search_again(arguments, options, *suggestion, findings);
  if (arguments.json) print_json(arguments, findings, lens);
  if (findings.hill) return kDone;
  note(
      "no metric and no window shows a clear focus, so settling and backlash cannot be measured: "
      "point the camera at something with texture that fills the window and does not move, and "
      "give it light");
  return kNoFocus;
}

}  // namespace fathom::cli
