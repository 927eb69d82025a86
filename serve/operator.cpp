// SPDX-License-Identifier: Apache-2.0
// What any thread may ask of the operator. operator_thread.cpp does it.
#include "serve/operator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "engine/windowed_metric.hpp"
#include "focus/focus.hpp"
#include "focus/searches.hpp"
#include "hal/clock.hpp"
#include "session/run_store.hpp"

namespace fathom::serve {
namespace {

constexpr const char* kBusy = "a measurement is under way; stop it, or wait until it is done";

}  // namespace

Operator::Operator(OperatorOptions options, Publisher& publisher)
    : options_(std::move(options)), publisher_(publisher) {
  parse_search_method(options_.search);
  open();
  const State state = publisher_.board.copy();
  const Window first =
      resolve_window(options_.rig.metric, options_.rig.window, state.width_px, state.height_px)
          .window;
  aim(options_.rig.metric, {first});
  publisher_.board.change([&](State& now) {
    now.version = options_.version;
    now.rig = options_.rig.rig;
    now.is_read_only = options_.is_read_only;
    now.search = options_.search;
    now.calibrations = calibrations_in(options_.folder);
  });
  thread_ = std::thread([this] { work(); });
  analyst_ = std::thread([this] { analyse(); });
}

void Operator::finish() {
  if (!thread_.joinable()) return;
  stop();
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  wakes_.notify_all();
  thread_.join();
  analyst_.join();
}

int Operator::requests() const {
  return stops_ - stops_before_ + options_.rig.shot.stop_requests();
}

/// Call it with the mutex held.
void Operator::require_idle() const {
  if (is_ending_) throw Busy("the service is ending");
  if (is_busy_) throw Busy(kBusy);
}

void Operator::push(Task task) {
  tasks_.push_back(std::move(task));
  wakes_.notify_all();
}

void Operator::check(const Order& order) const {
  const LensInfo lens = publisher_.board.read([](const State& state) { return state.lens; });
  const FocusLimits limits = resolve_limits(FocusRequest::within(order.from, order.to), lens);
  if (order.step) sweep_positions(lens, limits.from, limits.to, *order.step);
  constexpr int kMostFrames = 10'000;
  if (order.frames < 1 || order.frames > kMostFrames)
    throw Error(ErrorCode::bad_argument,
                fmt::format("{} frames; take 1 to {}", order.frames, kMostFrames));
  if (order.kind == Activity::calibrate && order.model != "auto")
    parse_calibration_model(order.model);
  if (order.kind != Activity::range && order.calibration.empty()) return;
  require_plain_name(order.calibration);
  if (!std::filesystem::is_regular_file(calibration_file(options_.folder, order.calibration))) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("there is no calibration {}; calibrate first", order.calibration));
  }
}

int Operator::start(Order order) {
  check(order);
  if (order.name.empty()) order.name = utc_for_name();
  require_plain_name(order.name);
  const std::lock_guard lock(mutex_);
  require_idle();
  is_busy_ = true;
  has_stopped_ = false;
  step_.reset();
  is_waiting_ = false;
  const int id = ++orders_;
  publisher_.change([&](State& state) {
    state.activity = order.kind;
    state.measurement = MeasurementView{.id = id, .kind = order.kind};
    if (order.kind == Activity::calibrate) state.calibration.emplace();
  });
  push([this, order = std::move(order), id, before = stops_.load()] {
    carry_out_order(order, id, before);
  });
  return id;
}

std::shared_ptr<LiveScores> Operator::scores() {
  const std::lock_guard lock(scores_mutex_);
  return scores_;
}

void Operator::aim(const std::string& metric, std::vector<Window> windows) {
  const State state = publisher_.board.copy();
  auto scores =
      std::make_shared<LiveScores>(metric, std::move(windows), state.width_px, state.height_px,
                                   options_.rig.backend, options_.rig.device);
  const std::vector<Window> aimed = scores->windows();
  {
    const std::lock_guard lock(scores_mutex_);
    scores_ = std::move(scores);
  }
  publisher_.change([&](State& now) {
    now.metric = metric;
    now.windows = aimed;
  });
}

void Operator::set_windows(std::vector<Window> windows) {
  const std::lock_guard lock(mutex_);
  require_idle();
  aim(publisher_.board.read([](const State& state) { return state.metric; }), std::move(windows));
}

void Operator::set_methods(const std::optional<std::string>& metric,
                           const std::optional<std::string>& search) {
  const std::lock_guard lock(mutex_);
  require_idle();
  if (search) parse_search_method(*search);
  const auto windows = publisher_.board.read([](const State& state) { return state.windows; });
  if (metric) aim(*metric, windows);
  if (search) publisher_.change([&](State& state) { state.search = *search; });
}

void Operator::move_lens(double position) {
  const LensInfo lens = publisher_.board.read([](const State& state) { return state.lens; });
  require_within(lens, position);
  const std::lock_guard lock(mutex_);
  require_idle();
  wanted_ = nearest_position(lens, position);
  if (std::exchange(is_sent_, true)) return;
  push([this, before = stops_.load()] { go_to_wanted(before); });
}

void Operator::move_lens_by(double change) {
  std::optional<double> from = publisher_.board.read([](const State& now) { return now.position; });
  {
    const std::lock_guard lock(mutex_);
    if (wanted_) from = wanted_;
  }
  if (!from) throw Error(ErrorCode::unavailable, "nobody knows where the lens stands");
  move_lens(*from + change);
}

void Operator::next_step(const NextStep& step) {
  const std::lock_guard lock(mutex_);
  if (!is_waiting_ || step_) throw Busy("no calibration waits for a distance now");
  step_ = step;
  publisher_.change([](State& state) { state.calibration->is_waiting = false; });
  wakes_.notify_all();
}

void Operator::stop() {
  // Whoever presses twice means it once; a second stop would end the lens's way back.
  constexpr std::int64_t kTwice_ns = 1'000'000'000;
  const std::lock_guard lock(mutex_);
  const std::int64_t now = monotonic_now_ns();
  const bool is_same =
      std::exchange(has_stopped_, true) && is_busy_ && now - stopped_ns_ < kTwice_ns;
  stopped_ns_ = now;
  if (is_same) return;
  ++stops_;
  wanted_.reset();
  if (is_busy_) {
    publisher_.change([](State& state) { state.activity = Activity::stopping; });
  }
  wakes_.notify_all();
}

}  // namespace fathom::serve
