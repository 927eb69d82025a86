// SPDX-License-Identifier: Apache-2.0
// The thread that has the rig.
#include <chrono>
#include <string>
#include <utility>

#include "engine/error.hpp"
#include "hal/clock.hpp"
#include "serve/operator.hpp"
#include "session/json_line.hpp"
#include "words/finding_words.hpp"

namespace fathom::serve {
namespace {

using std::chrono::milliseconds;

constexpr std::int64_t kMillisecond = 1'000'000;
/// Between two pictures that are shown, where they come by themselves or are computed.
constexpr std::int64_t kApart_ns = 33 * kMillisecond;
/// The same of a recording, which shows the same picture again.
constexpr std::int64_t kRecordedApart_ns = 200 * kMillisecond;
/// How long nobody may wait for a picture while something else may be asked for.
constexpr milliseconds kLookRound{50};

/// Nobody says how many bits a camera of more than 8 has: the fewest that hold what was seen.
int most_grey_of(const Frame& frame, int most) {
  for (int y = 0; y < frame.height_px(); ++y) {
    for (int x = 0; x < frame.width_px(); ++x) {
      while (most < static_cast<int>(frame.at(x, y))) most = 2 * most + 1;
    }
  }
  return most;
}

/// Where nobody knows where it stands, it says so when it is to move.
std::optional<double> position_of(const Lens& lens) {
  try {
    return lens.position();
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

void Operator::open() {
  const StopRequests stops = [this] { return requests(); };
  hardware_.emplace(
      open_hardware(options_.rig.rig, {.stop_requests = stops}),
      HardwareWatch{.frame = [this](const Frame& frame) { seen(frame); },
                    .departed = [this] { departed(); },
                    .arrived = [this](std::optional<Arrival> arrival) { arrived(arrival); }});
  eyes_ = hardware_->lend();
  for (const Finding& finding : eyes_.findings) publisher_.warn(words_for(finding));
  settled_ns_ = 0;
  describe();
}

void Operator::describe() {
  const CameraSettings picture = hardware_->camera().settings();
  publisher_.change([&](State& state) {
    state.description =
        hardware_->camera().description() + "; " + hardware_->lens().info().description;
    state.width_px = picture.width_px;
    state.height_px = picture.height_px;
    state.most_grey = most_grey_;
    state.is_streaming = hardware_->camera().streams();
    state.has_stage = hardware_->stage() != nullptr;
    state.lens = hardware_->lens().info();
    state.position = position_of(hardware_->lens());
    state.problem.clear();
  });
}

void Operator::work() {
  while (true) {
    if (const auto task = next_task()) {
      (*task)();
    } else if (is_ending_) {
      return;
    } else {
      show_live();
    }
  }
}

std::optional<Operator::Task> Operator::next_task() {
  std::unique_lock lock(mutex_);
  const auto has_task = [this] { return !tasks_.empty() || is_ending_; };
  if (!publisher_.has_watchers()) {
    wakes_.wait_for(lock, kLookRound, has_task);
  } else {
    const std::int64_t left = next_live_ns_ - monotonic_now_ns();
    if (left > 0) wakes_.wait_for(lock, std::chrono::nanoseconds(left), has_task);
  }
  if (tasks_.empty()) return std::nullopt;
  Task task = std::move(tasks_.front());
  tasks_.pop_front();
  return task;
}

void Operator::show_live() {
  if (!hardware_) return reopen();
  if (!publisher_.has_watchers() || monotonic_now_ns() < next_live_ns_) return;
  // A program that has the rig shows its own frames; every other one would be taken from it.
  constexpr std::int64_t kTaking_ns = 1'000 * kMillisecond;
  if (taken_ns_ != 0 && monotonic_now_ns() < taken_ns_ + kTaking_ns) {
    next_live_ns_ = taken_ns_ + kTaking_ns;
    return;
  }
  const bool is_live = hardware_->camera().is_live();
  const std::int64_t apart = is_live ? kApart_ns : kRecordedApart_ns;
  next_live_ns_ = hardware_->camera().streams() ? 0 : monotonic_now_ns() + apart;
  grab_live();
}

void Operator::grab_live() {
  try {
    eyes_.camera->grab(kLookRound);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::cancelled) lose(error);
  }
}

void Operator::lose(const Error& error) {
  publisher_.change([&](State& state) { state.problem = error.what(); });
  eyes_ = {};
  hardware_.reset();
}

/// A camera that was unplugged may come back.
void Operator::reopen() {
  constexpr std::int64_t kRetry_ns = 2'000 * kMillisecond;
  if (monotonic_now_ns() < retry_ns_) return;
  retry_ns_ = monotonic_now_ns() + kRetry_ns;
  try {
    open();
  } catch (const Error& error) {
    publisher_.board.change([&](State& state) { state.problem = error.what(); });
  }
}

void Operator::departed() {
  is_moving_ = true;
  tell_place([](State& state) { state.is_moving = true; });
}

void Operator::arrived(const std::optional<Arrival>& arrival) {
  is_moving_ = false;
  if (arrival) settled_ns_ = arrival->settled_ns;
  const auto position = position_of(hardware_->lens());
  tell_place([&](State& state) {
    state.is_moving = false;
    state.position = position;
  });
}

/// A measurement tells by its points where the lens goes; a state for each would tell all of them
/// every time.
void Operator::tell_place(const std::function<void(State&)>& change) {
  publisher_.board.change(change);
  const bool is_live =
      publisher_.board.read([](const State& state) { return state.activity == Activity::live; });
  if (is_live) publisher_.tell_state();
}

/// Every frame that the camera gives comes by here.
void Operator::seen(const Frame& frame) {
  if (!publisher_.has_watchers()) return;
  std::optional<double> position = frame.lens_position;
  if (!position && !is_moving_)
    position = publisher_.board.read([](const State& state) { return state.position; });
  const bool is_settled = !is_moving_ && frame.exposure.start_ns >= settled_ns_;
  const std::int64_t now = monotonic_now_ns();
  if (now - shown_ns_ >= kApart_ns / 2) {
    shown_ns_ = now;
    show(frame, position, is_settled);
  }
  if (publisher_.events.readers() > 0) tell_scores(frame, position, is_settled);
}

void Operator::show(const Frame& frame, std::optional<double> position, bool is_settled) {
  const int most = frame.depth() == Depth::bits8 ? 255 : most_grey_of(frame, most_grey_);
  if (std::exchange(most_grey_, most) != most)
    publisher_.change([&](State& state) { state.most_grey = most; });
  publisher_.pictures.show(frame, position, is_settled, most);
}

void Operator::tell_scores(const Frame& frame, std::optional<double> position, bool is_settled) {
  JsonLine line;
  line.add_json("stamp_ns", std::to_string(frame.exposure.start_ns));
  position ? line.add("position", *position) : line.add_null("position");
  line.add_json("settled", is_settled ? "true" : "false");
  publisher_.events.tell("score", line.add("scores", scores()->of(frame)).text());
}

/// A camera that streams shows the way.
Arrival Operator::travel_to(double to) {
  const bool is_seen = publisher_.has_watchers() && eyes_.camera->streams();
  if (!is_seen || !eyes_.lens->can_be_watched()) return eyes_.lens->move_to(to);
  const std::unique_ptr<Motion> motion = eyes_.lens->start(to);
  while (true) {
    if (const auto arrival = motion->arrived()) return *arrival;
    if (has_other_wish()) motion->stop();
    eyes_.camera->grab(kLookRound);
  }
}

bool Operator::has_other_wish() const {
  const std::lock_guard lock(mutex_);
  return wanted_.has_value();
}

void Operator::go_to_wanted(int stops_before) {
  stops_before_ = stops_before;
  while (true) {
    std::optional<double> to;
    {
      const std::lock_guard lock(mutex_);
      to = std::exchange(wanted_, std::nullopt);
      is_sent_ = to.has_value();
    }
    if (!to || !hardware_) return;
    try {
      travel_to(*to);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::cancelled) publisher_.warn(error.what());
    }
  }
}

NextStep Operator::wait_for_step() {
  // Whoever is told that it waits may answer at once.
  const auto tell_waiting = [this](bool is_waiting) {
    is_waiting_ = is_waiting;
    publisher_.change([&](State& state) { state.calibration->is_waiting = is_waiting; });
  };
  {
    const std::lock_guard lock(mutex_);
    tell_waiting(true);
  }
  while (true) {
    {
      const std::lock_guard lock(mutex_);
      const bool is_stopped = requests() > 0;
      if (is_stopped || step_) tell_waiting(false);
      if (is_stopped) throw Error(ErrorCode::cancelled, "stopped on request");
      if (step_) return *std::exchange(step_, std::nullopt);
    }
    if (publisher_.has_watchers()) {
      grab_live();
      if (!hardware_) throw Error(ErrorCode::device_lost, "the camera was lost");
    }
    std::unique_lock lock(mutex_);
    wakes_.wait_for(lock, std::chrono::nanoseconds(kApart_ns),
                    [this] { return step_ || requests() > 0; });
  }
}

void Operator::carry_out_order(const Order& order, int id, int stops_before) {
  stops_before_ = stops_before;
  Ending ending;
  if (!hardware_) {
    ending.failure = ErrorCode::device_lost;
    ending.outcome.error = "the rig is not there; it is tried again every 2 s";
    return end(order, id, ending);
  }
  const State state = publisher_.board.copy();
  const std::int64_t now = monotonic_now_ns();
  publisher_.board.change([&](State& shown) { shown.measurement->began_ns = now; });
  Work work{.order = order,
            .id = id,
            .began_ns = now,
            .hardware = *hardware_,
            .rig = options_.rig,
            .search = parse_search_method(state.search),
            .folder = options_.folder,
            .publisher = publisher_,
            .next_step = [this] { return wait_for_step(); }};
  work.rig.metric = state.metric;
  work.rig.window = state.windows[0];
  work.rig.shot.stop_requests = [this] { return requests(); };
  ending = carry_out(work);
  if (ending.outcome.window) take_window(*ending.outcome.window);
  end(order, id, ending);
}

/// In place of the first one, which is measured.
void Operator::take_window(const Window& window) {
  const State state = publisher_.board.copy();
  std::vector<Window> windows = state.windows;
  windows[0] = window;
  try {
    aim(state.metric, std::move(windows));
  } catch (const Error& error) {
    publisher_.warn(error.what());
  }
}

void Operator::end(const Order& order, int id, const Ending& ending) {
  const bool is_stopped = ending.failure == ErrorCode::cancelled;
  const std::string result = result_json(ending.outcome, publisher_.board.copy().lens);
  {
    const std::lock_guard lock(mutex_);
    is_busy_ = false;
    publisher_.board.change([&](State& state) {
      state.activity = Activity::live;
      state.measurement->result = result;
    });
  }
  publisher_.events.tell("found", result);
  JsonLine line;
  line.add("id", id).add("kind", to_string(order.kind));
  line.add("status", is_stopped ? "stopped" : ending.failure ? "failed" : "done");
  ending.failure ? line.add("error", ending.outcome.error) : line.add_null("error");
  publisher_.events.tell("ended", line.text());
  publisher_.tell_state();
}

}  // namespace fathom::serve
