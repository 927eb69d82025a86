// SPDX-License-Identifier: Apache-2.0
// fathom sweep: score every position of a range.
#include "session/session.hpp"
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/plot.hpp"
#include "tools/fathom/run_keeping.hpp"
#include "tools/fathom/search_view.hpp"
#include "tools/fathom/verbs.hpp"
#include "tools/fathom/warning_words.hpp"

namespace fathom::cli {
namespace {

struct Arguments {
  RigArguments rig;
  std::optional<double> from, to, step;
  std::string plot;
};

void sweep(Rig& rig, const Arguments& arguments, RunKeeper& keeper) {
  WarningNotes notes;
  LensReturn put_back(rig.lens(), notes);
  SweepView view("sweep", arguments.rig.json);
  Observers all({&keeper, &view, &notes});
  Session(rig).sweep({arguments.from, arguments.to, arguments.step}, all);
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
  const bool json = arguments.rig.json;
  RunKeeper keeper = start_run("sweep", rig);
  with_run_file(keeper.file, arguments.rig.output, json, [&] {
    sweep(rig, arguments, keeper);
    const auto evaluations = keeper.file.runs.back().evaluations();
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
  arguments->rig.add_to(verb, "File for the run (default: in ~/.local/state/fathom/runs)");
  verb.add_option("--from", arguments->from, "First lens position (default: the lens's lowest)");
  verb.add_option("--to", arguments->to, "Last lens position (default: the lens's highest)");
  verb.add_option("--step", arguments->step,
                  "Distance between positions (default: all recorded, or some hundred)");
  verb.add_option("--plot", arguments->plot, "FILE.svg, or - to draw the curve in the terminal");
  verb.on_run([arguments] { return run(*arguments); });
}

}  // namespace fathom::cli
