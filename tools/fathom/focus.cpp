// SPDX-License-Identifier: Apache-2.0
// fathom focus: find the lens position of best focus, and leave the lens there.
#include "session/session.hpp"
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/plot.hpp"
#include "tools/fathom/run_keeping.hpp"
#include "tools/fathom/search_view.hpp"
#include "tools/fathom/verbs.hpp"
#include "tools/fathom/verdict_words.hpp"
#include "tools/fathom/warning_words.hpp"

namespace fathom::cli {
namespace {

struct Arguments {
  RigArguments rig;
  SearchArguments search;
  std::string plot;
};

void print_result(const Focus& focus, const LensInfo& lens, bool json) {
  if (!json) return print_line(describe(focus, lens.unit));
  JsonLine line;
  print_line(add_focus(line, focus, lens).text());
  if (focus.result() != FocusResult::focused) note(words_for(focus.verdict));
}

Focus search(Rig& rig, const FocusRequest& request, RunKeeper& keeper, bool json) {
  WarningNotes notes;
  LensReturn put_back(rig.lens(), notes);
  SearchView view("", rig.lens().info().unit, json);
  Observers all({&keeper, &view, &notes});
  Focus focus = *Session(rig).focus(request, all).focus;
  if (focus.result() == FocusResult::focused) {
    rig.lens().move_to(rig.lens().nearest(focus.position()));
    put_back.release();
  }
  return focus;
}

int run(const Arguments& arguments) {
  require_plot_target(arguments.plot);
  require_separate({arguments.rig.rig}, {arguments.rig.output, arguments.plot});
  const FocusRequest request = arguments.search.request();
  Rig rig(arguments.rig.options());
  const LensInfo lens = rig.lens().info();
  const bool json = arguments.rig.json;
  RunKeeper keeper = start_run("focus", rig);
  bool focused = false;
  with_run_file(keeper.file, arguments.rig.output, json, [&] {
    const Focus focus = search(rig, request, keeper, json);
    focused = focus.result() == FocusResult::focused;
    plot(arguments.plot, focus.evaluations,
         {"Focus search on " + arguments.rig.rig, position_label(lens), score_label(rig.spec())},
         json);
    print_result(focus, lens, json);
    if (!json) print_line(describe(time_spent(keeper.file.runs.back().measurements)));
  });
  return focused ? kDone : kNoFocus;
}

}  // namespace

void add_focus(Verb& program) {
  Verb verb = program.add_verb("focus", "Search the lens for the best focus and leave it there");
  verb.set_footer(
      "Examples:\n  fathom focus --rig sim:target=seedling,distance=1800 --plot -\n"
      "  fathom focus --rig replay:stack/ --window 1000,700,128 --metric walsh-sequency --json\n\n"
      "Exit status: 0 focused, 1 error, 2 wrong usage, 3 no focus found (no-focus, at-limit or "
      "ambiguous).");
  auto arguments = std::make_shared<Arguments>();
  arguments->rig.add_to(verb, "File for the run (default: in ~/.local/state/fathom/runs)");
  arguments->search.add_to(verb);
  verb.add_option("--plot", arguments->plot, "FILE.svg, or - to draw the curve in the terminal");
  verb.on_run([arguments] { return run(*arguments); });
}

}  // namespace fathom::cli
