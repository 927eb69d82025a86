// SPDX-License-Identifier: Apache-2.0
// fathom focus: find the lens position of best focus, and leave the lens there.
#include "session/session.hpp"
#include "tools/fathom/aiming.hpp"
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/lens_blur.hpp"
#include "tools/fathom/plot.hpp"
#include "tools/fathom/run_keeping.hpp"
#include "tools/fathom/search_view.hpp"
#include "tools/fathom/verbs.hpp"
#include "tools/fathom/warning_notes.hpp"
#include "words/verdict_words.hpp"

namespace fathom::cli {
namespace {

struct Arguments {
  RigArguments rig;
  SearchArguments search;
  std::string plot;
};

void print_result(const Focus& focus, const Journey& journey, const LensInfo& lens, bool json) {
  if (!json) {
    print_line(describe(focus, lens.unit));
    return print_picture(lens, focus.position());
  }
  JsonLine line;
  add_focus(line, focus, lens);
  print_line(add_journey(line, journey).text());
  if (focus.result() != FocusResult::focused) note(words_for(focus.verdict));
}

Focus search(Rig& rig, LensBlur& blur, RunKeeper& keeper, bool json) {
  WarningNotes notes;
  LensReturn put_back(rig.lens(), notes);
  SearchView view("", rig.lens().info().unit, json);
  Observers all({&keeper, &view, &notes});
  Focus focus = *Session(rig).focus(blur.request(), all).focus;
  if (focus.result() == FocusResult::focused) {
    rig.lens().move_to(rig.lens().nearest(focus.position()));
    put_back.release();
  }
  blur.learn(keeper.file.runs.back());
  return focus;
}

int run(const Arguments& arguments) {
  require_plot_target(arguments.plot);
  require_separate({arguments.rig.rig}, {arguments.rig.output, arguments.plot});
  const FocusRequest request = arguments.search.request();
  std::optional<Rig> aimed = aimed_rig({.verb = "focus",
                                        .rig = arguments.rig,
                                        .from = arguments.search.from,
                                        .to = arguments.search.to,
                                        .blur = request.blur});
  if (!aimed) return kNoFocus;
  Rig& rig = *aimed;
  LensBlur blur = lens_blur(rig, request);
  const LensInfo lens = rig.lens().info();
  const bool json = arguments.rig.json;
  RunKeeper keeper = start_run("focus", rig);
  Focus focus;
  const auto measure = [&] { focus = search(rig, blur, keeper, json); };
  with_run_file(keeper.file, arguments.rig.output, json, measure, [&] {
    plot(arguments.plot, focus.evaluations,
         {"Focus search on " + arguments.rig.rig, position_label(lens), score_label(rig.spec())},
         json, &focus);
    const Run& run = keeper.file.runs.back();
    print_result(focus, journey_of(run), lens, json);
    if (!json) print_line(describe(journey_of(run), time_spent(run.measurements), lens.unit));
  });
  return focus.result() == FocusResult::focused ? kDone : kNoFocus;
}

}  // namespace

void add_focus(Verb& program) {
  Verb verb = program.add_verb("focus", "Search the lens for the best focus and leave it there");
  verb.set_footer(
      "Examples:\n  fathom focus --rig sim:target=seedling,distance=1800 --plot -\n"
      "  fathom focus --rig replay:stack/ --window 1000,700,128 --metric walsh-sequency --json\n"
      "  fathom focus --rig sim:target=stair --window auto\n\n"
      "Exit status: 0 focused, 1 error, 2 wrong usage, 3 no focus found (no-focus, at-limit or "
      "ambiguous).");
  auto arguments = std::make_shared<Arguments>();
  arguments->rig.add_to(verb, "File for the run (default: in ~/.local/state/fathom/runs)", true,
                        kAimHelp);
  arguments->search.add_to(verb);
  verb.add_option("--plot", arguments->plot, kPlotHelp);
  verb.on_run([arguments] { return run(*arguments); });
}

}  // namespace fathom::cli
