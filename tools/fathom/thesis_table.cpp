// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/thesis_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "backends/backends.hpp"
#include "session/rehearsal.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/patience.hpp"
#include "tools/fathom/window_time.hpp"

namespace fathom::cli {
namespace {

constexpr int kThesisSide = 64;
constexpr int kSearches = 50;

std::string text_of(double seconds) {
  const auto three = [](double value) {
    return fmt::format("{:.{}f}", value, value < 10 ? 2 : value < 100 ? 1 : 0);
  };
  if (seconds < 1e-3) return three(1e6 * seconds) + " us";
  return seconds < 1 ? three(1e3 * seconds) + " ms" : three(seconds) + " s";
}

double score_s(const RigOptions& options, const Frame& frame, Transform transform) {
  const MetricSpec spec = MetricSpec::standard(transform, kThesisSide);
  const Selection selection =
      select_device(all_backends(), options.backend, spec, 1, options.device);
  const auto plan = selection.device->plan(spec, 1);
  std::vector<Window> windows;
  for (int i = 0; i < kThesisSide; ++i) windows.push_back({2 * i, i, kThesisSide});
  return 1e-6 * time_windows(*plan, frame, windows, 1).median_us;
}

struct Search {
  std::size_t evaluations = 0;
  double computing_s = 0, cycle_s = 0;
};

/// The default search over the whole travel of a rig; a median.
Search time_search(Rig& rig) {
  Rehearsal rehearsal(rig, {});
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

void print_json(const ThesisTime& time) {
  print_line(JsonLine()
                 .add("thesis", time.what)
                 .add("thesis_least_s", time.least_s)
                 .add("thesis_most_s", time.most_s)
                 .add("here_s", time.here_s)
                 .text());
}

}  // namespace

std::string ThesisTime::thesis_text() const {
  const bool is_long = least_s >= 600;
  const double unit = is_long ? 60 : 1;
  const std::string most = fmt::format("{:g} {}", most_s / unit, is_long ? "min" : "s");
  return least_s == most_s ? most : fmt::format("{:g} to {}", least_s / unit, most);
}

std::string ThesisTime::here_text() const { return text_of(here_s); }

ThesisTimes measure_thesis_times(const std::string& backend) {
  RigOptions options;
  options.rig = "sim";
  options.backend = backend;
  options.device.on_work = patient_words();
  Rig rig(options);
  const Frame frame = take_frame(rig.camera(), 0, options.shot).clone();
  const double fft_s = score_s(options, frame, Transform::fft);
  const double walsh_s = score_s(options, frame, Transform::walsh_sequency);
  const Search search = time_search(rig);
  // What the thesis' 68010 took (T18).
  return {{{"one score of 64 x 64, FFT", 55, 55, fft_s},
           {"one score of 64 x 64, Walsh", 17, 17, walsh_s},
           {"the rest of a cycle: lens, camera", 30, 90, search.cycle_s},
           {"one distance; here, its computing alone", 1200, 1800, search.computing_s}},
          search.evaluations,
          search.computing_s,
          rig.selection().backend + ", " + rig.selection().device->info().name};
}

void print_thesis_table(const std::string& backend, bool json) {
  const ThesisTimes times = measure_thesis_times(backend);
  if (json) {
    for (const ThesisTime& time : times.rows) print_json(time);
    return;
  }
  constexpr const char* kColumns = "{:<42} {:>14} {:>12} {:>12}";
  print_line(fmt::format(kColumns, "the thesis (1989, 68010) and here", "thesis", "here", "times"));
  for (const ThesisTime& time : times.rows) {
    print_line(fmt::format(kColumns, time.what, time.thesis_text(), time.here_text(),
                           fmt::format("{:.3g}", time.times())));
  }
  print_line(fmt::format(
      "\nOne window a call. A distance is a default search of {} evaluations and its verdict; lens "
      "and "
      "camera are the\nsimulated rig's, by its clock: a rig takes as long as its own do.",
      times.evaluations));
}

}  // namespace fathom::cli
