// SPDX-License-Identifier: Apache-2.0
// fathom_gpu_throughput: windows per second of the vulkan or the opencl backend, from frames on the
// host and from frames that are on the device. One JSON object a line, each as soon as it is known;
// scores are compared with the cpu backend's before and after the clock runs. bench/gpu/measure
// runs it.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>
#include <numeric>
#include <stdexcept>

#include "backends/backends.hpp"
#include "bench/gpu/common.hpp"
#include "bench/gpu/target.hpp"
#include "engine/error.hpp"
#include "engine/selection.hpp"
#include "engine/tables.hpp"

namespace fathom::bench {
namespace {

constexpr int kNoDevice = 77;  // what ctest takes for "skipped"

struct Options {
  std::string device;  ///< "vulkan:INDEX", "opencl:INDEX"; empty: Vulkan's first real GPU.
  std::vector<int> sides = all_sides();
  std::vector<std::size_t> batches = all_batches();
  double cell_s = 0.3;
  double total_s = 1e9;
  std::size_t frame_bytes = kMostFrameBytes;
};

void print(const nlohmann::ordered_json& line) {
  fmt::print("{}\n", line.dump());
  std::fflush(stdout);  // a run that is cut off has lost nothing
}

/// What lines of this device are called: those of the opencl backend stand beside the other's.
std::string line_name(const std::string& device, const std::string& what) {
  return (device.starts_with("opencl:") ? "opencl-" : "") + what;
}

/// The device of that name, or nothing if there is no such one.
std::unique_ptr<Target> open(const std::string& name) {
#ifdef FATHOM_HAS_OPENCL
  Named found = name.starts_with("opencl:") ? opencl_target(name) : vulkan_target(name);
#else
  Named found = vulkan_target(name);
#endif
  if (found.target == nullptr) return nullptr;
  const DeviceInfo& info = found.target->info();
  print({{"what", line_name(name, "device")},
         {"label", found.label},
         {"name", info.name},
         {"kind", to_string(info.kind)},
         {"details", info.details}});
  return std::move(found.target);
}

/// The metrics and depths of one N: the two that have bars, and at N = 64 what else a kernel does;
/// there rings stand beside the moments of the same coefficients.
std::vector<std::pair<MetricSpec, Depth>> metrics(int n) {
  const auto fft = MetricSpec::standard(Transform::fft, n);
  const auto walsh = MetricSpec::standard(Transform::walsh_sequency, n);
  std::vector<std::pair<MetricSpec, Depth>> all = {{fft, Depth::bits8}, {walsh, Depth::bits8}};
  if (n == 64) {
    MetricSpec power = fft;
    power.power = true;
    all.emplace_back(power, Depth::bits8);
    all.emplace_back(fft, Depth::bits16);
    all.emplace_back(walsh, Depth::bits16);
    for (const MetricSpec& spec : {fft, power, walsh}) {
      all.emplace_back(MetricSpec::parse(spec.text() + ":rings=16"), Depth::bits8);
    }
  }
  return all;
}

std::vector<Cell> cells(const Options& options) {
  std::vector<Cell> all;
  for (const int n : options.sides) {
    for (const auto& [spec, depth] : metrics(n)) {
      const std::size_t most = options.frame_bytes / (bytes_per_pixel(depth) * n * n);
      for (const std::size_t batch : options.batches) {
        all.push_back({spec, depth, batch, Tiles::of(n, std::min(batch, most))});
      }
    }
  }
  return all;
}

/// What is added to a value before its error is judged: quantisation to whole grey levels leaves so
/// much in every ring, and a moment has none (docs/metrics.md, "Rings").
double least_scale(const MetricSpec& spec) {
  switch (spec.measure) {
    case Measure::moment:
    case Measure::entropy:
      return 0;
    case Measure::rings:
      break;
  }
  const auto taper = tables::taper(spec.taper, spec.n);
  const double squares = std::inner_product(taper.begin(), taper.end(), taper.begin(), 0.0);
  const double level = squares / std::sqrt(12.0) / (double(spec.n) * spec.n);
  return spec.power ? level * level : level;
}

double tolerance(const MetricSpec& spec) {
  switch (spec.measure) {
    case Measure::moment:
    case Measure::entropy:
      return spec.n <= 128 ? 2e-6 : 5e-6;
    case Measure::rings:
      return 1e-5;
  }
  return 0;
}

/// What the cpu backend makes of the same windows.
class Judge {
 public:
  explicit Judge(const Cell& cell)
      : windows_(cell.tiles.list()),
        tolerance_(tolerance(cell.spec)),
        least_scale_(least_scale(cell.spec)),
        selection_(select_device(all_backends(), "cpu", cell.spec, 1)),
        plan_(selection_.device->plan(cell.spec, windows_.size())),
        expected_(windows_.size() * cell.spec.outputs()) {}

  /// Throws std::runtime_error for scores that a backend may not give (docs/metrics.md, "How exact
  /// the scores are").
  void require_right(const Work& work) {
    for (const int seat : {0, 1}) {
      const auto scores = work.scores(seat);
      if (scores.empty()) continue;
      plan_->score(work.frame(seat), windows_, expected_);
      for (std::size_t i = 0; i < scores.size(); ++i) require_right(scores[i], i);
    }
  }

 private:
  void require_right(double score, std::size_t i) const {
    const MetricSpec& spec = plan_->spec();
    const double error = std::abs(score - expected_[i]);
    // Every comparison with NaN is false.
    if (spec.is_exact() ? score == expected_[i]
                        : error <= tolerance_ * (expected_[i] + least_scale_)) {
      return;
    }
    throw std::runtime_error(
        fmt::format("value {} is {:.17g}, not {:.17g}", i, score, expected_[i]));
  }

  std::vector<Window> windows_;
  double tolerance_, least_scale_;
  Selection selection_;
  std::unique_ptr<Plan> plan_;
  std::vector<double> expected_;
};

/// Times one kind of work, unless its scores are wrong, which is said.
void measure(const std::string& what, Work& work, Judge& judge, const Cell& cell, double budget_s,
             const std::string& device) {
  work.step();
  work.step();
  work.land();
  judge.require_right(work);
  const Times times = time_steps([&] { work.step(); }, budget_s);
  work.land();
  judge.require_right(work);
  const auto windows = static_cast<double>(cell.tiles.windows());
  print({{"what", what},
         {"metric", cell.spec.text()},
         {"depth", static_cast<int>(cell.depth)},
         {"batch", cell.batch},
         {"windows", cell.tiles.windows()},
         {"us_per_window", 1e6 * times.median_s / windows},
         {"windows_per_s", windows / times.median_s},
         {"min", 1e6 * times.min_s / windows},
         {"median", 1e6 * times.median_s / windows},
         {"max", 1e6 * times.max_s / windows},
         {"repetitions", times.repetitions},
         {"device", device}});
}

/// Whether all that the cell has was measured.
bool measure_all(Target& target, const Pixels& pixels, const Cell& cell, const Options& options) {
  const std::string& device = target.info().name;
  const auto name = [&](const char* what) { return line_name(options.device, what); };
  const double budget_s = options.cell_s;
  const char* doing = "resident";
  try {
    Judge judge(cell);
    measure(name(doing), *target.resident(pixels, cell), judge, cell, budget_s, device);
    doing = "streamed";
    measure(name(doing), *streamed(target.plan(cell.spec, cell.tiles.windows()), pixels, cell),
            judge, cell, budget_s, device);
    for (const bool copies_on_host : {true, false}) {
      doing = copies_on_host ? "upload" : "link";
      const auto work = target.upload(pixels, cell, copies_on_host);
      if (work) measure(name(doing), *work, judge, cell, budget_s / 2, device);
    }
    return true;
  } catch (const std::exception& error) {
    fmt::print(stderr, "fathom_gpu_throughput: NOT TIMED: {} {} of {} bits, batch {}: {}\n", doing,
               cell.spec.text(), static_cast<int>(cell.depth), cell.batch, error.what());
    print({{"what", "failed"},
           {"doing", name(doing)},
           {"metric", cell.spec.text()},
           {"depth", static_cast<int>(cell.depth)},
           {"batch", cell.batch},
           {"why", error.what()}});
    // Nothing that comes after is worth a device that is gone.
    if (target.is_lost()) throw;
    return false;
  }
}

int run(Options options) {
  std::unique_ptr<Target> target;
  try {
    target = open(options.device);
  } catch (const Error& error) {
    fmt::print(stderr, "fathom_gpu_throughput: {}\n", error.what());
  }
  if (target == nullptr) {
    fmt::print(stderr, "fathom_gpu_throughput: NOTHING IS TIMED: no {}; see `fathom devices`\n",
               options.device.empty() ? "Vulkan device that is a GPU" : options.device);
    return kNoDevice;
  }
  const std::uint64_t room = target->buffer_bytes();
  options.frame_bytes = std::min<std::uint64_t>(options.frame_bytes, room);
  std::size_t most = 0;
  const auto all = cells(options);
  for (const Cell& cell : all) most = std::max(most, cell.tiles.bytes(cell.depth));
  const Pixels pixels(most);
  const double end = seconds() + options.total_s;
  std::size_t failed = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (seconds() > end) {
      fmt::print(stderr, "fathom_gpu_throughput: OUT OF TIME: {} of {} cells are not measured\n",
                 all.size() - i, all.size());
      break;
    }
    failed += !measure_all(*target, pixels, all[i], options);
  }
  return failed > 0 ? 1 : 0;
}

}  // namespace
}  // namespace fathom::bench

int main(int argc, char** argv) try {
  fathom::bench::Options options;
  CLI::App app{"Windows per second of the vulkan or the opencl backend, resident and streamed."};
  app.add_option("--device", options.device,
                 "vulkan:INDEX or opencl:INDEX; else Vulkan's first real GPU");
  app.add_option("--sides", options.sides, "which N, in this order")
      ->delimiter(',')
      ->check(CLI::IsMember({8, 16, 32, 64, 128, 256, 512}));
  app.add_option("--batches", options.batches, "how many windows a call, in this order")
      ->delimiter(',')
      ->check(CLI::Range(1, 1 << 20));
  app.add_option("--cell-seconds", options.cell_s, "how long each figure is measured at least");
  app.add_option("--seconds", options.total_s, "starts no cell after so long");
  CLI11_PARSE(app, argc, argv);
  return fathom::bench::run(options);
} catch (const std::exception& error) {
  fmt::print(stderr, "fathom_gpu_throughput: {}\n", error.what());
  return 1;
}
