// SPDX-License-Identifier: Apache-2.0
// fathom replay: run a record's searches, fits and conversions again from its scores.
#include "engine/error.hpp"
#include "engine/file.hpp"
#include "session/run_file.hpp"
#include "tools/fathom/plot.hpp"
#include "tools/fathom/run_keeping.hpp"
#include "tools/fathom/search_view.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {
namespace {

struct Arguments {
  std::string record;
  std::string plot;
  bool json = false;
};

void print_run(const RunFile& record, const Run& run, bool json) {
  if (json) {
    for (const Evaluation& e : run.evaluations()) print_evaluation(e, run.limits.has_value());
  }
  if (!run.focus) return;
  if (!json) return print_line(describe(*run.focus, record.setup.lens.unit));
  JsonLine line;
  print_line(add_focus(line, *run.focus, record.setup.lens).text());
}

void print_distance(const Distance& distance, bool json) {
  if (json) {
    return print_line(
        JsonLine().add("distance_mm", distance.mm).add("sigma_mm", distance.sigma_mm).text());
  }
  print_line(fmt::format("distance {:.1f} mm +- {:.1f} mm", distance.mm, distance.sigma_mm));
}

int run(const Arguments& arguments) {
  require_plot_target(arguments.plot);
  require_separate({arguments.record}, {arguments.plot});
  constexpr std::uintmax_t kLargest = 1u << 30;
  const RunFile recorded = RunFile::parse(read_file(arguments.record, kLargest), arguments.record);
  const RunFile again = replay(recorded, arguments.record);
  if (!arguments.json) {
    print_line(fmt::format("{}: {} ({})", recorded.setup.created, recorded.setup.command,
                           recorded.setup.metric.text()));
  }
  for (const Run& run : again.runs) print_run(again, run, arguments.json);
  if (again.distance) print_distance(*again.distance, arguments.json);
  if (!again.runs.empty()) {
    plot(arguments.plot, again.runs.back().evaluations(),
         {"RunFile " + arguments.record, "lens position (" + again.setup.lens.unit + ")",
          "focus quality, " + again.setup.metric.text()},
         arguments.json);
  }
  if (!recorded.error.empty()) note("the recorded run ended early: " + recorded.error);
  if (!same_answer(recorded, again)) {
    throw Error(
        ErrorCode::bad_data,
        fmt::format("{} does not replay to the answer that it holds; it was made by another "
                    "version or changed by hand",
                    arguments.record));
  }
  note("the record replays to the same answer");
  return kDone;
}

}  // namespace

void add_replay(Verb& program) {
  Verb verb = program.add_verb("replay", "Run a record again and check that its answer holds");
  verb.set_footer("Example:\n  fathom replay run.json --plot curve.svg");
  auto arguments = std::make_shared<Arguments>();
  verb.add_option("record", arguments->record, "A record of sweep, focus, calibrate or range")
      .required();
  verb.add_option("--plot", arguments->plot,
                  "FILE.svg, or - to draw the last curve in the terminal");
  verb.add_flag("--json", arguments->json, "One JSON object a line on standard output");
  verb.on_run([arguments] { return run(*arguments); });
}

}  // namespace fathom::cli
