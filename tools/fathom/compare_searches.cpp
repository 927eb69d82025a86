// SPDX-License-Identifier: Apache-2.0
// fathom compare-searches: every search on the same simulated scenes.
#include <algorithm>
#include <numeric>

#include "engine/error.hpp"
#include "focus/searches.hpp"
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/comparison.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/patience.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {
namespace {

struct Arguments {
  ComparisonScenes scenes;
  std::vector<std::string> searches;
  std::string metric = "fft";
  std::string backend;
  bool json = false;
};

double mean(const std::vector<double>& values) {
  if (values.empty()) return 0;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double largest(const std::vector<double>& values) {
  return values.empty() ? 0 : *std::max_element(values.begin(), values.end());
}

std::vector<Contender> chosen(const std::vector<std::string>& searches) {
  std::vector<Contender> all = all_contenders();
  if (searches.empty()) return all;
  std::vector<Contender> some;
  for (const std::string& name : searches) {
    const SearchMethod method = parse_search_method(name);
    std::copy_if(all.begin(), all.end(), std::back_inserter(some),
                 [method](const Contender& one) { return one.search == method; });
  }
  return some;
}

std::string search_names() {
  std::string names;
  for (const Search& search : searches())
    names += std::string(names.empty() ? "" : ", ") + search.name;
  return names;
}

void print_json(const SearchTally& tally) {
  print_line(JsonLine()
                 .add("search", tally.contender.name)
                 .add("method", to_string(tally.contender.search))
                 .add("runs", tally.runs)
                 .add("right", tally.right)
                 .add("trapped", tally.trapped)
                 .add("wrong", tally.wrong)
                 .add("declined", tally.declined)
                 .add("evaluations_mean", mean(tally.evaluations))
                 .add("evaluations_most", largest(tally.evaluations))
                 .add("error_percent_mean", mean(tally.errors_percent))
                 .add("error_percent_most", largest(tally.errors_percent))
                 .add("travel_mean", mean(tally.moved_steps))
                 .text());
}

void print_table(const std::vector<SearchTally>& tallies) {
  constexpr const char* kRow = "{:<31} {:>6} {:>8} {:>6} {:>9} {:>11} {:>11} {:>8} {:>7}";
  print_line(fmt::format(kRow, "search", "right", "trapped", "wrong", "declined", "evaluations",
                         "mean error", "worst", "travel"));
  for (const SearchTally& s : tallies) {
    const auto percent = [&](int count) { return fmt::format("{:.0f} %", 100.0 * count / s.runs); };
    print_line(
        fmt::format(kRow, s.contender.name, percent(s.right), percent(s.trapped), percent(s.wrong),
                    percent(s.declined),
                    fmt::format("{:.1f} ({:g})", mean(s.evaluations), largest(s.evaluations)),
                    s.right > 0 ? fmt::format("{:.3f} %", mean(s.errors_percent)) : "-",
                    s.right > 0 ? fmt::format("{:.2f} %", largest(s.errors_percent)) : "-",
                    fmt::format("{:.0f}", mean(s.moved_steps))));
  }
  print_line(
      "\nright: focused, off by less than half of the depth of field. trapped: ended farther off; "
      "wrong: and was said to be focused.\ndeclined: ended at the right place, but not said to be "
      "focused. evaluations: mean (most). errors: of the right ones.\ntravel: of the lens, steps. "
      "(thesis): the best position evaluated is the answer; else a fit.");
}

void require_scenes(const ComparisonScenes& scenes) {
  if (scenes.count() > 0) return;
  throw Error(ErrorCode::bad_argument,
              "nothing to compare on: give targets, distances, noises, "
              "starts and at least one seed");
}

RigOptions options_of(const Arguments& arguments) {
  RigOptions options;
  options.metric = arguments.metric;
  options.backend = arguments.backend;
  options.device.on_work = patient_words();
  return options;
}

int run(const Arguments& arguments) {
  require_scenes(arguments.scenes);
  const std::vector<Contender> contenders = chosen(arguments.searches);
  const std::size_t total = contenders.size() * arguments.scenes.count();
  if (!arguments.json) {
    print_line(fmt::format("{} scenes, {}\n", arguments.scenes.count(), arguments.metric));
  }
  Progress progress;
  const auto tallies =
      compare_searches(contenders, arguments.scenes, options_of(arguments), [&](std::size_t done) {
        if (stop_requested()) throw Error(ErrorCode::cancelled, "stopped on request");
        progress.bar("compare", done, total);
      });
  progress.clear();
  if (!arguments.json) {
    print_table(tallies);
    return kDone;
  }
  for (const SearchTally& tally : tallies) print_json(tally);
  return kDone;
}

}  // namespace

void add_compare_searches(Verb& program) {
  Verb verb = program.add_verb("compare-searches", "Run every search on the same simulated scenes");
  verb.set_footer(
      "Examples:\n  fathom compare-searches\n"
      "  fathom compare-searches --searches auto,golden,hill --targets usaf --noise 1,3 --seeds 5");
  auto arguments = std::make_shared<Arguments>();
  ComparisonScenes& scenes = arguments->scenes;
  const auto add_list = [&](const char* name, auto& values, const std::string& help) {
    verb.add_option(name, values, help).takes_commas().shows_default();
  };
  add_list("--targets", scenes.targets, "Of the simulated rig: usaf, seedling, orange");
  add_list("--distances", scenes.distances_mm, "Of the targets, mm");
  add_list("--noise", scenes.noises, "Of the camera, 1 is the thesis'");
  add_list("--starts", scenes.starts, "Where the lens stands before, steps");
  verb.add_option("--seeds", scenes.seeds, "Repetitions with other noise")
      .at_least_one()
      .shows_default();
  add_list("--searches", arguments->searches,
           search_names() + " (default: all; full takes most of the time)");
  verb.add_option("--metric", arguments->metric, "What is computed").shows_default();
  verb.add_option("--backend", arguments->backend, "As fathom devices lists them");
  verb.add_flag("--json", arguments->json, "One JSON object a search on standard output");
  verb.on_run([arguments] { return run(*arguments); });
}

}  // namespace fathom::cli
