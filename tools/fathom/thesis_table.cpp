// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/thesis_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "backends/backends.hpp"
#include "ranging/rehearsal.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/window_time.hpp"

namespace fathom::cli {
namespace {

constexpr int kThesisSide = 64;
constexpr int kSearches = 50;

/// What the thesis' 68010 took (T18), seconds.
struct ThesisTime {
  double least_s = 0, most_s = 0;
};
constexpr ThesisTime kFft{55, 55}, kWalsh{17, 17}, kCycle{30, 90}, kDistance{1200, 1800};

/// "55 s", "20 to 30 min".
std::string text_of(const ThesisTime& time) {
  const bool is_long = time.least_s >= 600;
  const double unit = is_long ? 60 : 1;
  const std::string most = fmt::format("{:g} {}", time.most_s / unit, is_long ? "min" : "s");
  return time.least_s == time.most_s ? most : fmt::format("{:g} to {}", time.least_s / unit, most);
}

/// Three digits and a unit.
std::string text_of(double seconds) {
  const auto three = [](double value) {
    return fmt::format("{:.{}f}", value, value < 10 ? 2 : value < 100 ? 1 : 0);
  };
  if (seconds < 1e-3) return three(1e6 * seconds) + " us";
  return seconds < 1 ? three(1e3 * seconds) + " ms" : three(seconds) + " s";
}

double score_s(const std::string& backend, const Frame& frame, Transform transform) {
  const MetricSpec spec = MetricSpec::standard(transform, kThesisSide);
  const Selection selection = select_device(all_backends(), backend, spec, 1);
  const auto plan = selection.device->plan(spec, 1);
  std::vector<Window> windows;
  for (int i = 0; i < kThesisSide; ++i) windows.push_back({2 * i, i, kThesisSide});
  return 1e-6 * time_windows(*plan, frame, windows, 1).median_us;
}

class Table {
 public:
  explicit Table(bool json) : json_(json) {
    if (json_) return;
    print_line(
        fmt::format(kColumns, "the thesis (1989, 68010) and here", "thesis", "here", "times"));
  }

  void add(const char* what, const ThesisTime& thesis, double here_s) const {
    if (json_) {
      print_line(JsonLine()
                     .add("thesis", what)
                     .add("thesis_least_s", thesis.least_s)
                     .add("thesis_most_s", thesis.most_s)
                     .add("here_s", here_s)
                     .text());
      return;
    }
    // The lesser ratio, where the thesis has two.
    print_line(fmt::format(kColumns, what, text_of(thesis), text_of(here_s),
                           fmt::format("{:.3g}", thesis.least_s / here_s)));
  }

 private:
  static constexpr const char* kColumns = "{:<42} {:>14} {:>12} {:>12}";
  bool json_;
};

struct Search {
  std::size_t evaluations = 0;
  double computing_s = 0, cycle_s = 0;
};

/// The default search over the whole travel of a rig; a median.
Search time_search(Rig& rig) {
  Rehearsal rehearsal(rig, {}, kRepeatFrames);
  Search search;
  search.cycle_s = rehearsal.cycle_s();
  std::vector<double> times;
  for (int i = 0; i < kSearches; ++i) {
    const auto start = std::chrono::steady_clock::now();
    const Focus focus = rehearsal.run();
    times.push_back(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    search.evaluations = focus.evaluations.size();
  }
  std::nth_element(times.begin(), times.begin() + kSearches / 2, times.end());
  search.computing_s = times[kSearches / 2];
  return search;
}

}  // namespace

void print_thesis_table(const std::string& backend, bool json) {
  RigOptions options;
  options.rig = "sim";
  options.backend = backend;
  Rig rig(options);
  const Frame frame = take_frame(rig.camera(), 0, options.shot).clone();
  const double fft_s = score_s(backend, frame, Transform::fft);
  const double walsh_s = score_s(backend, frame, Transform::walsh_sequency);
  const Search search = time_search(rig);
  const Table table(json);
  table.add("one score of 64 x 64, FFT", kFft, fft_s);
  table.add("one score of 64 x 64, Walsh", kWalsh, walsh_s);
  table.add("the rest of a cycle: lens, camera", kCycle, search.cycle_s);
  table.add("one distance; here, its computing alone", kDistance, search.computing_s);
  if (json) return;
  print_line(fmt::format(
      "\nOne window a call. A distance is a default search of {} evaluations and its verdict; lens "
      "and "
      "camera are the\nsimulated rig's, by its clock: a rig takes as long as its own do.",
      search.evaluations));
}

}  // namespace fathom::cli
