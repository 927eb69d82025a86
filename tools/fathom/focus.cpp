// SPDX-License-Identifier: Apache-2.0
// fathom focus: find the lens position of best focus, and leave the lens there.
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/plot.hpp"
#include "tools/fathom/run_keeping.hpp"
#include "tools/fathom/search_view.hpp"
#include "tools/fathom/verbs.hpp"
#include "tools/fathom/verdict_words.hpp"

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

Focus search(Rig& rig, const FocusRequest& request, Run& run, bool json) {
  LensReturn put_back(rig.lens(), note);
  SearchView view("", rig.lens().info().unit, json);
  Focus focus = search_on_rig(rig, request, run, [&](const Evaluation& e) { view.show(e); });
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
  RunFile record = start_record("focus", rig);
  bool focused = false;
  with_record(record, arguments.rig.output, json, [&] {
    const Focus focus = search(rig, request, record.runs.emplace_back(), json);
    focused = focus.result() == FocusResult::focused;
    plot(arguments.plot, focus.evaluations,
         {"Focus search on " + arguments.rig.rig, position_label(lens), score_label(rig.spec())},
         json);
    print_result(focus, lens, json);
    if (!json) print_line(describe(time_spent(record.runs.back().measurements)));
  });
  return focused ? kDone : kNoFocus;
}

}  // namespace

void add_focus(CLI::App& app, int& status) {
  auto* const verb =
      app.add_subcommand("focus", "Search the lens for the best focus and leave it there");
  verb->footer(
      "Examples:\n  fathom focus --rig sim:target=seedling,distance=1800 --plot -\n"
      "  fathom focus --rig replay:stack/ --window 1000,700,128 --metric walsh-sequency --json\n\n"
      "Exit status: 0 focused, 1 error, 2 wrong usage, 3 no focus found (no-focus, at-limit or "
      "ambiguous).");
  auto arguments = std::make_shared<Arguments>();
  arguments->rig.add_to(*verb, "File for the record (default: in ~/.local/state/fathom/records)");
  arguments->search.add_to(*verb);
  verb->add_option("--plot", arguments->plot, "FILE.svg, or - to draw the curve in the terminal");
  verb->callback([arguments, &status] { status = run(*arguments); });
}

}  // namespace fathom::cli
