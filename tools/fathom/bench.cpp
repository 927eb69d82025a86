// SPDX-License-Identifier: Apache-2.0
// fathom bench: what one window takes on this machine.
#include <algorithm>
#include <set>

#include "backends/backends.hpp"
#include "engine/device_list.hpp"
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/benchmark.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/patience.hpp"
#include "tools/fathom/thesis_table.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {
namespace {

/// What the thesis' 68010 took for one 64 x 64 window.
constexpr double kThesisFft_s = 55, kThesisWalsh_s = 17;
constexpr int kThesisSide = 64;

struct Arguments {
  std::vector<std::string> metrics = {"fft", "walsh-sequency"};
  std::vector<std::string> backends;
  std::vector<int> threads, batches;
  int depth = 8;
  bool json = false, thesis_only = false;

  /// Whether nobody asked for anything in particular.
  bool is_whole() const {
    return metrics == Arguments().metrics && backends.size() <= 1 && threads.empty() &&
           batches.empty() && depth == 8;
  }
};

std::vector<std::string> choices(const Arguments& arguments) {
  std::vector<std::string> choices;
  const OnWork say = patient_words();
  for (const std::string& wanted : arguments.backends) {
    if (wanted != "all") {
      choices.push_back(wanted);
      continue;
    }
    for (const Backend* backend : all_backends()) {
      if (backend->is_for_gpus()) say(Work::listing, backend->name());
      const std::size_t count = list_devices(*backend).size();
      say(Work::done, {});
      for (std::size_t i = 0; i < count; ++i) {
        choices.push_back(fmt::format("{}:{}", backend->name(), i));
      }
    }
  }
  // The empty choice is FATHOM_BACKEND's, else auto's: what the other verbs would take.
  if (arguments.backends.empty()) choices.emplace_back();
  return choices;
}

/// The metrics of one text: itself, or every size where it names none.
std::vector<MetricSpec> sizes_of(const std::string& metric) {
  if (MetricSpec::names_n(metric)) return {MetricSpec::parse(metric)};
  std::vector<MetricSpec> specs;
  for (int n = kSmallestWindow; n <= kLargestWindow; n *= 2) {
    specs.push_back(MetricSpec::parse(metric, n));
  }
  return specs;
}

/// Threads and batches of each metric's rows.
std::vector<std::pair<int, int>> loads(const Arguments& arguments) {
  std::vector<int> threads = arguments.threads;
  if (threads.empty()) threads = {1, kDecideLater};
  std::vector<int> batches = arguments.batches;
  if (batches.empty()) batches = {1, kDecideLater};
  // One window keeps one processor busy, so the other row for it is only for those who ask.
  const bool usual = arguments.threads.empty() && arguments.batches.empty();
  std::vector<std::pair<int, int>> loads;
  for (const int batch : batches) {
    for (const int count : threads) {
      if (!(usual && batch == 1 && count != 1)) loads.emplace_back(count, batch);
    }
  }
  return loads;
}

std::vector<BenchCase> cases(const Arguments& arguments) {
  std::vector<BenchCase> cases;
  for (const std::string& choice : choices(arguments)) {
    for (const std::string& metric : arguments.metrics) {
      for (const MetricSpec& spec : sizes_of(metric)) {
        for (const auto& [threads, batch] : loads(arguments)) {
          cases.push_back({.choice = choice,
                           .series = metric,
                           .spec = spec,
                           .may_skip = !MetricSpec::names_n(metric),
                           .threads = threads,
                           .batch = batch});
        }
      }
    }
  }
  return cases;
}

/// 12 345 678
std::string grouped(double value) {
  std::string digits = fmt::format("{:.0f}", value);
  for (std::size_t end = digits.size(); end > 3; end -= 3) digits.insert(end - 3, " ");
  return digits;
}

double thesis_time_s(TransformFamily family) {
  switch (family) {
    case TransformFamily::fourier:
      return kThesisFft_s;
    case TransformFamily::walsh:
      return kThesisWalsh_s;
    case TransformFamily::cosine:
      break;  // the thesis had none
  }
  return 0;
}

/// Whether the thesis computed it: a moment, the only measure it had, of one of its transforms.
bool is_of_thesis(const MetricSpec& spec) {
  switch (spec.measure) {
    case Measure::moment:
      return spec.n == kThesisSide && thesis_time_s(family_of(spec.transform)) > 0;
    case Measure::rings:
    case Measure::entropy:
      return false;
  }
  return false;
}

/// How many times faster than the thesis.
std::string thesis_ratio(const BenchRow& row) {
  if (!is_of_thesis(row.spec)) return "-";
  const double thesis_s = thesis_time_s(family_of(row.spec.transform));
  return grouped(1e6 * thesis_s / row.time.median_us);
}

/// Rows as they come: a table, or JSON lines.
class Report {
 public:
  Report(bool json, const Frame& frame) : json_(json), frame_(frame) {}

  void show(const BenchRow& row) {
    if (json_) return print_json(row);
    const std::string device =
        fmt::format("{}: {}: {}", row.backend, row.device.name, row.device.details);
    if (devices_.insert(device).second) print_heading(device);
    const WindowTime& time = row.time;
    print_line(fmt::format(kColumns, row.spec.text(), row.backend, row.batch, row.threads,
                           fmt::format("{:.3f}", time.median_us),
                           fmt::format("{:.3f} .. {:.3f}", time.min_us, time.max_us),
                           grouped(1e6 / time.median_us), fmt::format("{:.3g}", bandwidth(row)),
                           thesis_ratio(row)));
  }

  void finish() const {
    if (devices_.empty()) return;
    print_line(
        fmt::format("\nMedian times, and from the shortest to the longest. GB/s: pixels of the "
                    "windows.\nx thesis: against the {:g} s (FFT) and {:g} s (Walsh) of the "
                    "thesis' 68010, which had moments of {} x {} windows only.",
                    kThesisFft_s, kThesisWalsh_s, kThesisSide, kThesisSide));
  }

 private:
  static constexpr const char* kColumns =
      "{:<22} {:<10} {:>6} {:>8} {:>10} {:>20} {:>11} {:>6} {:>11}";

  void print_heading(const std::string& device) const {
    if (devices_.size() > 1) print_line("");
    print_line(fmt::format("{}\nwindows of a random {} x {} px frame of {} bits\n", device,
                           frame_.width_px(), frame_.height_px(),
                           static_cast<int>(frame_.depth())));
    print_line(fmt::format(kColumns, "metric", "backend", "batch", "threads", "us/window",
                           "min .. max", "windows/s", "GB/s", "x thesis"));
  }

  double bandwidth(const BenchRow& row) const {
    return gigabytes_per_s(row.spec.n, static_cast<int>(frame_.depth()) / 8, row.time.median_us);
  }

  void print_json(const BenchRow& row) const {
    JsonLine line;
    line.add("backend", row.backend)
        .add("metric", row.spec.text())
        .add("batch", row.batch)
        .add("threads", row.threads)
        .add("us_per_window", row.time.median_us)
        .add("windows_per_s", 1e6 / row.time.median_us)
        .add("min_us", row.time.min_us)
        .add("max_us", row.time.max_us)
        .add("lower_quartile_us", row.time.lower_quartile_us)
        .add("upper_quartile_us", row.time.upper_quartile_us)
        .add("gigabytes_per_s", bandwidth(row))
        .add("device", row.device.name);
    if (row.is_one_thread()) {
      line.add("processor_share", row.time.processor_share);
    } else {
      line.add_null("processor_share");
    }
    print_line(line.text());
  }

  bool json_;
  const Frame& frame_;
  std::set<std::string> devices_;  // whose heading was printed
};

int run(const Arguments& arguments) {
  const std::string backend = arguments.backends.empty() ? "" : arguments.backends.front();
  if (arguments.thesis_only) {
    print_thesis_table(backend, arguments.json);
    return kDone;
  }
  const auto wanted = cases(arguments);
  Benchmark::require_valid(wanted);
  Benchmark benchmark(arguments.depth);
  Report report(arguments.json, benchmark.frame());
  std::set<std::string> silent;  // the choices without a row
  for (const BenchCase& one : wanted) silent.insert(one.choice);
  double least_share = 1;
  Progress progress;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    progress.bar("bench", i, wanted.size());
    const auto row = benchmark.measure(wanted[i]);
    progress.clear();
    if (!row) continue;
    report.show(*row);
    if (row->is_one_thread()) least_share = std::min(least_share, row->time.processor_share);
    silent.erase(wanted[i].choice);
  }
  report.finish();
  if (is_busy(least_share)) note(busy_text(least_share));
  if (arguments.is_whole() && !arguments.json && backend != "all" && silent.empty()) {
    print_line("");
    print_thesis_table(backend, false);
  }
  return silent.empty() ? kDone : kError;
}

}  // namespace

void add_bench(Verb& program) {
  Verb verb = program.add_verb("bench", "Time what one window takes on this machine");
  verb.set_footer(
      "Examples:\n  fathom bench\n"
      "  fathom bench --metric fft:64 --metric walsh-sequency:64 --backend all --threads 1 --json");
  auto arguments = std::make_shared<Arguments>();
  verb.add_option("--metric", arguments->metrics,
                  "A metric, repeatable; one without N means all sizes (default: fft and "
                  "walsh-sequency; all Walsh orders take the same time)")
      .takes_one_at_a_time();
  verb.add_option("--backend", arguments->backends,
                  "auto, NAME, NAME:DEVICE or all, repeatable (default: $FATHOM_BACKEND, else "
                  "auto)")
      .takes_one_at_a_time();
  verb.add_option("--threads", arguments->threads,
                  "Processors that may compute, repeatable (default: 1, and $FATHOM_THREADS, else "
                  "all); a row says how many the device uses at most")
      .takes_one_at_a_time()
      .takes_commas()
      .at_least_one();
  verb.add_option("--batch", arguments->batches,
                  "Windows of one call, repeatable (default: 1, and enough to fill the machine)")
      .takes_one_at_a_time()
      .takes_commas()
      .at_least_one();
  verb.add_option("--depth", arguments->depth, "Bits of a pixel, 8 or 16")
      .one_of({8, 16})
      .shows_default();
  verb.add_flag("--thesis", arguments->thesis_only,
                "Only the thesis' times against this machine's, which the whole bench ends with");
  verb.add_flag("--json", arguments->json, "One JSON object a line on standard output");
  verb.on_run([arguments] { return run(*arguments); });
}

}  // namespace fathom::cli
