// SPDX-License-Identifier: Apache-2.0
// fathom sweep: score every position of a range.
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/plot.hpp"
#include "tools/fathom/run_keeping.hpp"
#include "tools/fathom/search_view.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {
namespace {

struct Arguments {
  RigArguments rig;
  std::optional<double> from, to, step;
  std::string plot;
};

std::vector<double> positions(Rig& rig, const Arguments& arguments) {
  const LensInfo lens = rig.lens().info();
  const FocusLimits limits =
      resolve_limits(FocusRequest::within(arguments.from, arguments.to), lens);
  if (!arguments.step) return sweep_positions(rig.lens().info(), limits.from, limits.to);
  if (*arguments.step > 0 && *arguments.step < lens.resolution) {
    note(fmt::format("the lens has no positions {:g} {} apart; each that it has is taken once",
                     *arguments.step, lens.unit));
  }
  return sweep_positions(rig.lens().info(), limits.from, limits.to, *arguments.step);
}

void sweep(Rig& rig, const std::vector<double>& positions, Run& run, bool json) {
  LensReturn put_back(rig.lens(), note);
  Progress progress;
  for (const double position : positions) {
    const Measurement measurement = rig.measure(position);
    run.measurements.push_back(measurement);
    const Evaluation evaluation{0, measurement.position, measurement.score};
    if (json) {
      print_evaluation(evaluation, false);
    }
    progress.bar("sweep", run.measurements.size(), positions.size());
  }
}

void print_table(const std::vector<Evaluation>& evaluations, const LensInfo& lens) {
  print_line(fmt::format("{:>12}  score", lens.unit));
  for (const Evaluation& e : evaluations)
    print_line(fmt::format("{:>12g}  {:.6g}", e.position, e.score));
}

int run(const Arguments& arguments) {
  require_plot_target(arguments.plot);
  require_separate({arguments.rig.rig}, {arguments.rig.output, arguments.plot});
  Rig rig(arguments.rig.options());
  const LensInfo lens = rig.lens().info();
  const auto wanted = positions(rig, arguments);
  note_inexact_positions(rig.lens(), wanted);
  const bool json = arguments.rig.json;
  RunFile record = start_record("sweep", rig);
  with_record(record, arguments.rig.output, json, [&] {
    Run& run = record.runs.emplace_back();
    sweep(rig, wanted, run, json);
    const auto evaluations = run.evaluations();
    const Evaluation& best = best_of(evaluations);
    if (!json && arguments.plot != "-") print_table(evaluations, lens);
    plot(arguments.plot, evaluations,
         {"Focus sweep of " + arguments.rig.rig, position_label(lens), score_label(rig.spec())},
         json);
    if (!json) {
      print_line(
          fmt::format("highest score {:.6g} at {:g} {}", best.score, best.position, lens.unit));
    }
  });
  return kDone;
}

}  // namespace

void add_sweep(Verb& program) {
  Verb verb = program.add_verb("sweep", "Score every position of a range");
  verb.set_footer(
      "Examples:\n  fathom sweep --rig sim:target=usaf,distance=1500 --from 800 --to 1100 --step "
      "10 --plot -\n"
      "  fathom sweep --rig replay:stack.tif --json");
  auto arguments = std::make_shared<Arguments>();
  arguments->rig.add_to(verb, "File for the record (default: in ~/.local/state/fathom/records)");
  verb.add_option("--from", arguments->from, "First lens position (default: the lens's lowest)");
  verb.add_option("--to", arguments->to, "Last lens position (default: the lens's highest)");
  verb.add_option("--step", arguments->step,
                  "Distance between positions (default: all recorded, or some hundred)");
  verb.add_option("--plot", arguments->plot, "FILE.svg, or - to draw the curve in the terminal");
  verb.on_run([arguments] { return run(*arguments); });
}

}  // namespace fathom::cli
