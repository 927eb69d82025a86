// SPDX-License-Identifier: Apache-2.0
// fathom sweep: score every position of a range.
#include "session/session.hpp"
#include "tools/fathom/aiming.hpp"
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/lens_blur.hpp"
#include "tools/fathom/plot.hpp"
#include "tools/fathom/run_keeping.hpp"
#include "tools/fathom/search_view.hpp"
#include "tools/fathom/verbs.hpp"
#include "tools/fathom/warning_notes.hpp"

namespace fathom::cli {
namespace {

struct Arguments {
  RigArguments rig;
  std::optional<double> from, to, step;
  bool is_moving = false;
  std::string plot;
};

void sweep(Rig& rig, const Arguments& arguments, RunKeeper& keeper) {
  WarningNotes notes;
  LensReturn put_back(rig.lens(), notes);
  SweepView view("sweep", rig.lens().info(), arguments.rig.json);
  Observers all({&keeper, &view, &notes});
  Session(rig).sweep({.from = arguments.from,
                      .to = arguments.to,
                      .step = checked_step(arguments.step),
                      .is_moving = arguments.is_moving},
                     all);
  FocusRequest none;
  none.search = SearchMethod::full;
  lens_blur(rig, none).learn(keeper.file.runs.back());
}

void print_table(const std::vector<Evaluation>& evaluations, const LensInfo& lens) {
  print_line(fmt::format("{:>12}  score", lens.unit));
  for (const Evaluation& e : evaluations)
    print_line(fmt::format("{:>12g}  {:.6g}", e.position, e.score));
}

void print_moving_table(const std::vector<Measurement>& measurements, const LensInfo& lens) {
  print_line(fmt::format("{:>12}  {:>8}  {:>8}  score", lens.unit, "sigma", "smear"));
  for (const Measurement& m : measurements) {
    const OnTheWay way = m.on_the_way.value_or(OnTheWay{});
    print_line(fmt::format("{:>12.6g}  {:>8.2g}  {:>8.2g}  {:.6g}", m.position, way.sigma,
                           way.smear, m.score));
  }
}

/// What the travel cost, to be held beside a sweep with halts.
void print_journey(const Run& run, const LensInfo& lens, bool json) {
  const Journey journey = journey_of(run);
  if (!json) return print_line(describe(journey, time_spent(run.measurements), lens.unit));
  JsonLine line;
  print_line(add_journey(line, journey).text());
}

int run(const Arguments& arguments) {
  require_plot_target(arguments.plot);
  require_separate({arguments.rig.rig}, {arguments.rig.output, arguments.plot});
  checked_step(arguments.step);  // wrong usage is said before anything is looked at
  std::optional<Rig> aimed = aimed_rig(
      {.verb = "sweep", .rig = arguments.rig, .from = arguments.from, .to = arguments.to});
  if (!aimed) return kNoFocus;
  Rig& rig = *aimed;
  const LensInfo lens = rig.lens().info();
  const bool json = arguments.rig.json;
  RunKeeper keeper = start_run("sweep", rig);
  const auto measure = [&] { sweep(rig, arguments, keeper); };
  with_run_file(keeper.file, arguments.rig.output, json, measure, [&] {
    const Run& swept = keeper.file.runs.back();
    const auto evaluations = swept.evaluations();
    const Evaluation& best = best_of(evaluations);
    if (!json && arguments.plot != "-") {
      arguments.is_moving ? print_moving_table(swept.measurements, lens)
                          : print_table(evaluations, lens);
    }
    plot(arguments.plot, evaluations,
         {"Focus sweep of " + arguments.rig.rig, position_label(lens), score_label(rig.spec())},
         json);
    if (!json) {
      print_line(
          fmt::format("highest score {:.6g} at {:g} {}", best.score, best.position, lens.unit));
      print_picture(lens, best.position);
    }
    const bool has_cost = arguments.is_moving || !json;
    if (has_cost && rig.camera().is_live()) print_journey(swept, lens, json);
  });
  return kDone;
}

}  // namespace

void add_sweep(Verb& program) {
  Verb verb = program.add_verb("sweep", "Score every position of a range");
  verb.set_footer(
      "Examples:\n  fathom sweep --rig sim:target=usaf,distance=1500 --from 800 --to 1100 --step "
      "10 --plot -\n"
      "  fathom sweep --rig sim --from 700 --to 900 --moving\n"
      "  fathom sweep --rig replay:stack.tif --json");
  auto arguments = std::make_shared<Arguments>();
  arguments->rig.add_to(verb, "File for the run (default: in ~/.local/state/fathom/runs)", true,
                        kAimHelp);
  verb.add_option("--from", arguments->from, "First lens position (default: the lens's lowest)");
  verb.add_option("--to", arguments->to, "Last lens position (default: the lens's highest)");
  verb.add_option("--step", arguments->step,
                  "Distance between positions (default: all recorded, or some hundred)");
  verb.add_flag("--moving", arguments->is_moving,
                "Score frames on one travel without a halt, no nearer to each other than --step "
                "(needs a lens that can be watched, and a live camera)");
  verb.add_option("--plot", arguments->plot, kPlotHelp);
  verb.on_run([arguments] { return run(*arguments); });
}

}  // namespace fathom::cli
