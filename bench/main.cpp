// SPDX-License-Identifier: Apache-2.0
// fathom_bench: time from pixels to scores, ours and the peers', by Google Benchmark.
// Names are score/CONTESTANT/METRIC/batch:WINDOWS, with /depth:16 where not of 8 bits and
// /threads:all where not on one thread; bench/flows.hpp has the rest.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "bench/agreement.hpp"
#include "bench/contestants.hpp"
#include "bench/flows.hpp"
#include "bench/scene.hpp"

namespace fathom::bench {
namespace {

/// By name. To be emptied before the end: libraries may not outlive main().
auto& kept_scorers() {
  static std::map<std::string, Scorer> scorers;
  return scorers;
}

/// A contestant's scorer for a metric: made when first asked for, because planning takes seconds,
/// and kept, because repetitions come back to it.
const Scorer& kept_scorer(const std::string& name, const std::function<Scorer()>& make) {
  auto& scorers = kept_scorers();
  if (const auto known = scorers.find(name); known != scorers.end()) return known->second;
  return scorers.emplace(name, make()).first->second;
}

/// What is scored in one call.
struct Call {
  int n = 0;
  std::size_t batch = 1;
  Depth depth = Depth::bits8;
  std::size_t outputs = 1;  ///< Numbers of a window.
};

void run(benchmark::State& state, const Call& call, const std::function<const Scorer&()>& scorer) {
  static const Frame frames[] = {random_frame(), random_frame(Depth::bits16)};
  const Frame& frame = frames[call.depth == Depth::bits16];
  const std::size_t batch = call.batch;
  const auto windows = scattered_windows(call.n, std::max<std::size_t>(batch, 64));
  std::vector<double> scores(batch * call.outputs);
  try {
    const Scorer& score = scorer();
    std::size_t first = 0;
    for (auto _ : state) {
      score(frame, std::span(windows).subspan(first, batch), scores);
      benchmark::DoNotOptimize(scores.data());
      benchmark::ClobberMemory();
      first = first + 2 * batch <= windows.size() ? first + batch : 0;  // one place would stay hot
    }
  } catch (const std::exception& error) {
    state.SkipWithError(error.what());
    return;
  }
  const auto scored = static_cast<double>(state.iterations()) * static_cast<double>(batch);
  using benchmark::Counter;
  state.counters["per_window"] = Counter(scored, Counter::kIsRate | Counter::kInvert);
}

/// make: the scorer, once it is known to agree.
auto* add(const std::string& who, const std::string& metric, const Call& call, const char* threads,
          const std::function<Scorer()>& make) {
  const std::string name = fmt::format("score/{}/{}/batch:{}{}{}", who, metric, call.batch,
                                       call.depth == Depth::bits16 ? "/depth:16" : "", threads);
  const std::string key = who + "/" + metric + threads;
  return benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
    run(state, call, [&]() -> const Scorer& { return kept_scorer(key, make); });
  });
}

void add(const Contestant& contestant, const MetricSpec& spec, const Call& call) {
  const auto make = [&contestant, spec] {
    Scorer scorer = contestant.prepare(spec, batch_size(spec.n));
    require_agreement(contestant.name, scorer, spec);
    return scorer;
  };
  auto* const added =
      add(contestant.name, spec.text(), call, contestant.all_threads ? "/threads:all" : "", make);
  // Else the calling thread's own time, which others on the machine disturb least.
  if (contestant.works_elsewhere) added->UseRealTime();
}

/// Rings, and the moment of the same masses where the standard metric's are others.
void add_rings(const Contestant& contestant, Transform transform, int n) {
  MetricSpec spec = MetricSpec::standard(transform, n);
  switch (family_of(transform)) {
    case TransformFamily::fourier:
      spec.power = true;
      add(contestant, spec, {.n = n, .batch = batch_size(n)});
      spec.rings = n < 32 ? n / 4 : 16;  // no ring may be empty
      break;
    case TransformFamily::walsh:
    case TransformFamily::cosine:
      spec.rings = 8;
      break;
  }
  spec.measure = Measure::rings;
  add(contestant, spec, {.n = n, .batch = batch_size(n), .outputs = spec.outputs()});
}

void add_all(const std::vector<Contestant>& contestants) {
  for (const Contestant& contestant : contestants) {
    for (const Transform transform : contestant.transforms) {
      for (int n = kSmallestWindow; n <= contestant.largest_n; n *= 2) {
        const auto spec = timed_metric(transform, n);
        add(contestant, spec, {n, 1});
        add(contestant, spec, {n, batch_size(n)});
        if (contestant.takes_16_bits) add(contestant, spec, {n, batch_size(n), Depth::bits16});
        if (contestant.measures_rings && spec.measure == Measure::moment)
          add_rings(contestant, transform, n);
      }
    }
  }
}

void add_all(std::span<const OtherMetric> metrics) {
  for (const OtherMetric& metric : metrics) {
    for (int n = kSmallestWindow; n <= kLargestWindow; n *= 2) {
      add(metric.contestant, fmt::format("{}:{}", metric.metric, n), {n, batch_size(n)}, "",
          [&metric, n] {
            Scorer scorer = peer_scorer(metric.prepare(n));
            require_agreement(scorer, metric, n);
            return scorer;
          });
    }
  }
}

}  // namespace
}  // namespace fathom::bench

int main(int argc, char** argv) {
  using fathom::bench::Planning;
  const auto contestants = fathom::bench::all_contestants(Planning::patient);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  fathom::bench::add_all(contestants);
  fathom::bench::add_all(fathom::bench::other_metrics());
  fathom::bench::add_flows(FATHOM_PROGRAM);
  benchmark::RunSpecifiedBenchmarks();
  fathom::bench::kept_scorers().clear();
  benchmark::Shutdown();
  return 0;
}
