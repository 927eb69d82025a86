// SPDX-License-Identifier: Apache-2.0
// fathom rerun: compute a run's searches, fits and conversions again from its scores.
#include <algorithm>

#include "engine/error.hpp"
#include "engine/file.hpp"
#include "engine/printable.hpp"
#include "session/run_file.hpp"
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/plot.hpp"
#include "tools/fathom/run_keeping.hpp"
#include "tools/fathom/search_view.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {
namespace {

struct Arguments {
  std::string file;
  std::string plot;
  bool json = false;
};

RunFile load_run(const std::string& path) {
  constexpr std::uintmax_t kLargest = 1u << 30;
  const std::string text = read_file(path, kLargest);
  try {
    return RunFile::parse(text, path);
  } catch (const Error& error) {
    throw Error(error.code(), fmt::format("{}; fathom focus -o FILE makes one", error.what()));
  }
}

void print_run(const RunFile& file, const Run& run, bool json) {
  const LensInfo& lens = file.setup.lens;
  const bool is_search = run.limits.has_value();
  if (json) {
    for (const Evaluation& e : run.evaluations())
      print_line(evaluation_json(e, is_search, is_search ? "" : nearest_name(lens, e.position)));
  }
  if (!run.focus) return;
  if (!json) {
    print_line(describe(*run.focus, lens.unit));
    print_picture(lens, run.focus->position());
    return;
  }
  JsonLine line;
  print_line(add_focus(line, *run.focus, lens).text());
}

void print_distance(const Distance& distance, bool json) {
  if (json) {
    return print_line(
        JsonLine().add("distance_mm", distance.mm).add("sigma_mm", distance.sigma_mm).text());
  }
  print_line(fmt::format("distance {:.1f} mm +- {:.1f} mm", distance.mm, distance.sigma_mm));
}

void print_surface(const KeptSurface& surface, const std::string& unit, bool json) {
  const auto& distance = surface.distance;
  if (json) {
    JsonLine line;
    if (distance) {
      line.add("distance_mm", distance->mm).add("sigma_mm", distance->sigma_mm);
    } else {
      line.add_null("distance_mm").add_null("sigma_mm");
    }
    return print_line(
        line.add("position", surface.position).add("sigma", place_sigma(surface)).text());
  }
  const std::string place = fmt::format("at {:.6g} +- {:.2g} {}", surface.position,
                                        place_sigma(surface), printable(unit));
  print_line(distance ? fmt::format("surface {}: {:.1f} mm +- {:.1f} mm", place, distance->mm,
                                    distance->sigma_mm)
                      : "surface " + place);
}

bool has_answer(const RunFile& file) {
  const auto has_focus = [](const Run& run) { return run.focus.has_value(); };
  return file.calibration || file.distance || std::ranges::any_of(file.runs, has_focus);
}

/// What was checked, and what cannot be.
std::string words_for_same(const RunFile& file) {
  if (file.surfaces) {
    return fmt::format(
        "{}; the surfaces follow from pictures, which a run does not keep, so they "
        "cannot be checked",
        file.calibration ? "the distances follow from the positions as before"
                         : "positions without a calibration follow from nothing else");
  }
  return has_answer(file) ? "the run comes to the same answer"
                          : "a sweep comes to no answer, so there is none to check";
}

int run(const Arguments& arguments) {
  require_plot_target(arguments.plot);
  require_separate({arguments.file}, {arguments.plot});
  const RunFile kept = load_run(arguments.file);
  const RunFile again = rerun(kept, arguments.file);
  if (!arguments.json) {
    print_line(fmt::format("{}: {} ({})", printable(kept.setup.created),
                           printable(kept.setup.command), kept.setup.metric.text()));
  }
  for (const Run& run : again.runs) print_run(again, run, arguments.json);
  if (again.distance) print_distance(*again.distance, arguments.json);
  if (again.surfaces) {
    for (const KeptSurface& surface : *again.surfaces)
      print_surface(surface, again.setup.lens.unit, arguments.json);
  }
  if (!again.runs.empty()) {
    const Run& last = again.runs.back();
    plot(arguments.plot, last.evaluations(),
         {"Run " + arguments.file, position_label(again.setup.lens),
          score_label(again.setup.metric)},
         arguments.json, last.focus ? &*last.focus : nullptr);
  } else if (!arguments.plot.empty()) {
    note("the run holds no curve to plot: it is of a recording's pictures");
  }
  if (!kept.error.empty()) note("the run ended early: " + kept.error);
  if (!same_answer(kept, again)) {
    throw Error(
        ErrorCode::bad_data,
        fmt::format("{} does not come to the answer that it holds; it was made by another version "
                    "or changed by hand",
                    arguments.file));
  }
  if (kept.is_as_written == false) {
    throw Error(ErrorCode::bad_data,
                fmt::format("{} was changed after it was written; what does not follow from its "
                            "scores, such as rig, window and times, may not be what was measured",
                            arguments.file));
  }
  note(words_for_same(kept));
  if (!kept.is_as_written) {
    note(
        "the file has no digest: what does not follow from its scores, such as rig, window and "
        "times, cannot be checked");
  }
  return kDone;
}

}  // namespace

void add_rerun(Verb& program) {
  Verb verb = program.add_verb("rerun", "Compute a run again and check that its answer holds");
  verb.set_footer("Example:\n  fathom rerun run.json --plot curve.svg");
  auto arguments = std::make_shared<Arguments>();
  verb.add_option("run", arguments->file, "What sweep, focus, calibrate or range has kept")
      .required();
  verb.add_option("--plot", arguments->plot,
                  "FILE.svg, FILE.png, or - to draw the last curve in the terminal");
  verb.add_flag("--json", arguments->json, "One JSON object a line on standard output");
  verb.on_run([arguments] { return run(*arguments); });
}

}  // namespace fathom::cli
