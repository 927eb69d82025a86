// SPDX-License-Identifier: Apache-2.0
#include "python/scoring.hpp"

#include <fmt/format.h>
#include <pybind11/complex.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <deque>
#include <list>
#include <memory>

#include "backends/backends.hpp"
#include "engine/windowed_metric.hpp"
#include "python/arrays.hpp"
#include "python/errors.hpp"
#include "python/given.hpp"
#include "python/stop.hpp"

namespace fathom::python {
namespace {

using Choice = std::optional<std::string>;

/// What a scorer was made for.
struct Purpose {
  std::string metric;
  Choice backend;
  int threads = 0;
  std::size_t batch = 1;

  bool operator==(const Purpose&) const = default;
};

struct Kept {
  Purpose purpose;
  Scorer scorer;
};

/// Scorers that no call uses now. Only ever touched with Python's lock held, so it needs none.
class Pool {
 public:
  std::unique_ptr<Kept> take(const Purpose& purpose, const MetricSpec& spec) {
    for (auto kept = idle_.begin(); kept != idle_.end(); ++kept) {
      if ((*kept)->purpose != purpose) continue;
      std::unique_ptr<Kept> taken = std::move(*kept);
      idle_.erase(kept);
      return taken;
    }
    const auto threads = purpose.threads > 0 ? std::optional(purpose.threads) : std::nullopt;
    return std::unique_ptr<Kept>(
        new Kept{purpose, open_scorer(spec, purpose.backend, threads, purpose.batch)});
  }

  void give_back(std::unique_ptr<Kept> kept) {
    constexpr std::size_t kMostIdle = 16;
    idle_.push_front(std::move(kept));
    if (idle_.size() > kMostIdle) idle_.pop_back();
  }

  void clear() { idle_.clear(); }

 private:
  std::deque<std::unique_ptr<Kept>> idle_;  // the one used last comes first
};

/// Never destroyed: threads may still be in it while a process ends.
Pool& pool() {
  static Pool* const one = new Pool;
  return *one;
}

/// A scorer for the time of one call.
class Borrowed {
 public:
  Borrowed(const Purpose& purpose, const MetricSpec& spec) : kept_(pool().take(purpose, spec)) {}
  Borrowed(const Borrowed&) = delete;
  Borrowed& operator=(const Borrowed&) = delete;
  /// A scorer whose call failed may be of a lost device, and is not kept.
  ~Borrowed() {
    if (is_good_) pool().give_back(std::move(kept_));
  }
  void is_good() { is_good_ = true; }
  Kept* operator->() { return kept_.get(); }

 private:
  std::unique_ptr<Kept> kept_;
  bool is_good_ = false;
};

/// Calls of some more windows share a plan; of few, where `auto` decides by their number, none do.
std::size_t batch_for(std::size_t windows, int n) {
  constexpr std::size_t kFew = 16;
  const std::size_t most = full_batch(n);
  return std::min(windows <= kFew ? windows : std::bit_ceil(windows), most);
}

/// Last texts, parsed: a call of one window takes less time than parsing does.
const MetricSpec& parsed(const std::string& metric) {
  constexpr std::size_t kMost = 16;
  static auto* const seen = new std::list<std::pair<std::string, MetricSpec>>;
  for (const auto& [text, spec] : *seen) {
    if (text == metric) return spec;
  }
  seen->emplace_front(metric, MetricSpec::parse(metric));
  if (seen->size() > kMost) seen->pop_back();
  return seen->front().second;
}

/// Where the numbers of the windows go: the axes of the result.
struct Aim {
  Windows windows;
  std::vector<py::ssize_t> axes;
};

Aim grid_aim(const Pictures& pictures, int n, int stride) {
  if (stride < 1) refuse(fmt::format("stride is {}; it is 1 px or more", stride));
  require_in_picture({0, 0, n}, "image", pictures.width_px(), pictures.height_px());
  const WindowGrid grid(pictures.width_px(), pictures.height_px(), {0, 0, n}, stride);
  const auto along = [&](int side) { return (side - n) / stride + 1; };
  return {grid, {along(pictures.height_px()), along(pictures.width_px())}};
}

Aim list_aim(const Pictures& pictures, py::handle windows, int n) {
  std::vector<Window> list;
  const bool is_one = read_windows(windows, pictures.width_px(), pictures.height_px(), n, list);
  std::vector<py::ssize_t> axes;
  if (!is_one) axes.push_back(static_cast<py::ssize_t>(list.size()));
  return {Windows(std::move(list)), std::move(axes)};
}

/// Scores a picture in portions that take some 50 ms each, between which Python looks for signals.
class Portions {
 public:
  explicit Portions(Scorer& scorer) : scorer_(scorer), size_(first_size(scorer)) {}

  void score(const Frame& frame, std::span<double> values) {
    const std::size_t outputs = scorer_.outputs(), windows = values.size() / outputs;
    for (std::size_t first = 0; first < windows;) {
      const std::size_t count = std::min(size_, windows - first);
      const auto start = Clock::now();
      scorer_.score(frame, first, values.subspan(first * outputs, count * outputs));
      first += count;
      if (first == windows) return;
      adapt(std::chrono::duration<double>(Clock::now() - start).count());
      watch_.look();
    }
  }

  void look() { watch_.look(); }

 private:
  using Clock = std::chrono::steady_clock;

  /// As many as any device takes in a moment; the oracle takes its time for each.
  static std::size_t first_size(const Scorer& scorer) {
    constexpr std::size_t kPixels = std::size_t{1} << 20;
    const auto n = static_cast<std::size_t>(scorer.spec().n);
    return scorer.selection().backend == "reference" ? 1 : kPixels / (n * n);
  }

  void adapt(double seconds) {
    constexpr double kSeconds = 0.05, kMostTimes = 4;
    const double times = std::clamp(kSeconds / std::max(seconds, 1e-9), 1 / kMostTimes, kMostTimes);
    size_ = std::max<std::size_t>(static_cast<std::size_t>(static_cast<double>(size_) * times), 1);
  }

  Scorer& scorer_;
  std::size_t size_;
  SignalWatch watch_;
};

void score_all(Scorer& scorer, const Pictures& pictures, std::span<double> values) {
  const std::size_t each = values.size() / pictures.size();
  const py::gil_scoped_release unlocked;
  Portions portions(scorer);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    portions.score(pictures.frame(i), values.subspan(i * each, each));
    if (pictures.size() > 1) portions.look();
  }
}

py::object score(py::handle image, py::handle metric_text, py::handle windows, py::handle stride_px,
                 py::handle backend, py::handle threads) {
  const std::string metric = given_text(metric_text, "metric");
  const MetricSpec spec = parsed(metric);
  const std::optional<int> stride = wished_count(stride_px, "stride");
  const Pictures pictures(image, "image");
  if (stride && !windows.is_none()) refuse("give windows or stride, not both");
  Aim aim = stride ? grid_aim(pictures, spec.n, *stride) : list_aim(pictures, windows, spec.n);
  Borrowed scorer({.metric = metric,
                   .backend = wished_text(backend, "backend"),
                   .threads = thread_count(wished_count(threads, "threads")),
                   .batch = batch_for(aim.windows.size(), spec.n)},
                  spec);
  scorer->scorer.aim(std::move(aim.windows));
  std::vector<py::ssize_t> shape = std::move(aim.axes);
  if (pictures.is_stack()) shape.insert(shape.begin(), static_cast<py::ssize_t>(pictures.size()));
  if (spec.measure == Measure::rings) shape.push_back(spec.rings);
  py::array_t<double> values(shape);
  score_all(scorer->scorer, pictures,
            {values.mutable_data(), static_cast<std::size_t>(values.size())});
  scorer.is_good();
  if (shape.empty()) return py::float_(*values.data());
  return values;
}

py::array spectrum(py::handle image, py::handle metric, py::handle window, py::handle backend,
                   py::handle threads) {
  const MetricSpec spec = parsed(given_text(metric, "metric")).plain();
  const Pictures pictures(image, "image");
  if (pictures.is_stack()) refuse("image is a stack; a spectrum is of one picture");
  std::vector<Window> list;
  const bool is_one =
      read_windows(window, pictures.width_px(), pictures.height_px(), spec.n, list, "window");
  if (!is_one) refuse("window holds several corners; a spectrum is of one window (x, y)");
  const Scorer scorer =
      open_scorer(spec, wished_text(backend, "backend"), wished_count(threads, "threads"), 1);
  const auto plan = scorer.selection().device->plan(spec, 1);
  py::array_t<std::complex<double>> values({spec.n, spec.n});
  {
    const std::span all(values.mutable_data(), static_cast<std::size_t>(values.size()));
    const py::gil_scoped_release unlocked;
    plan->spectrum(pictures.frame(0), list[0], all);
  }
  if (family_of(spec.transform) == TransformFamily::fourier) return values;
  return values.attr("real").attr("copy")().cast<py::array>();
}

}  // namespace

int thread_count(std::optional<int> threads) {
  if (threads && *threads < 1) refuse(fmt::format("threads is {}; it is 1 or more", *threads));
  return threads.value_or(0);
}

Scorer open_scorer(const MetricSpec& spec, const std::optional<std::string>& backend,
                   std::optional<int> threads, std::size_t batch) {
  const DeviceOptions options = {.threads = thread_count(threads)};
  const py::gil_scoped_release unlocked;
  return Scorer(select_device(all_backends(), backend.value_or(""), spec, batch, options), spec,
                batch);
}

void bind_scoring(py::module_& module) {
  module.def("score", &score);
  module.def("spectrum", &spectrum);
  module.def("clear_pool", [] { pool().clear(); });
}

}  // namespace fathom::python
