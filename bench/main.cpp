// SPDX-License-Identifier: Apache-2.0
// fathom_bench: time from pixels to scores, ours and the peers', by Google Benchmark.
// Names are score/CONTESTANT/METRIC/batch:WINDOWS, with /depth:16 where not of 8 bits and
// /threads:all where not on one thread; bench/flows.hpp has the rest.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <exception>
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

/// By contestant and metric. To be emptied before the end: libraries may not outlive main().
auto& kept_scorers() {
  static std::map<std::pair<const Contestant*, std::string>, Scorer> scorers;
  return scorers;
}

/// The contestant's scorer for a metric: made when first asked for, because planning takes seconds,
/// and kept, because repetitions come back to it.
const Scorer& prepared(const Contestant& contestant, const MetricSpec& spec) {
  auto& scorers = kept_scorers();
  const auto key = std::pair(&contestant, spec.text());
  if (const auto known = scorers.find(key); known != scorers.end()) return known->second;
  Scorer scorer = contestant.prepare(spec, batch_size(spec.n));
  require_agreement(contestant.name, scorer, spec);
  return scorers.emplace(key, std::move(scorer)).first->second;
}

void run(benchmark::State& state, const Contestant& contestant, const MetricSpec& spec,
         std::size_t batch, Depth depth) {
  static const Frame frames[] = {random_frame(), random_frame(Depth::bits16)};
  const Frame& frame = frames[depth == Depth::bits16];
  const auto windows = scattered_windows(spec.n, std::max<std::size_t>(batch, 64));
  std::vector<double> scores(batch);
  try {
    const Scorer& score = prepared(contestant, spec);
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

void add(const Contestant& contestant, const MetricSpec& spec, std::size_t batch, Depth depth) {
  const std::string name = fmt::format("score/{}/{}/batch:{}{}{}", contestant.name, spec.text(),
                                       batch, depth == Depth::bits16 ? "/depth:16" : "",
                                       contestant.all_threads ? "/threads:all" : "");
  auto* const added = benchmark::RegisterBenchmark(
      name.c_str(), [&contestant, spec, batch, depth](benchmark::State& state) {
        run(state, contestant, spec, batch, depth);
      });
  // Else the calling thread's own time, which others on the machine disturb least.
  if (contestant.works_elsewhere) added->UseRealTime();
}

void add_all(const std::vector<Contestant>& contestants) {
  for (const Contestant& contestant : contestants) {
    for (const Transform transform : contestant.transforms) {
      for (int n = kSmallestWindow; n <= contestant.largest_n; n *= 2) {
        const auto spec = MetricSpec::standard(transform, n);
        for (const std::size_t batch : {std::size_t{1}, batch_size(n)}) {
          add(contestant, spec, batch, Depth::bits8);
        }
        if (contestant.takes_16_bits) add(contestant, spec, batch_size(n), Depth::bits16);
      }
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
  fathom::bench::add_flows(FATHOM_PROGRAM);
  benchmark::RunSpecifiedBenchmarks();
  fathom::bench::kept_scorers().clear();
  benchmark::Shutdown();
  return 0;
}
