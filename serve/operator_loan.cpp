// SPDX-License-Identifier: Apache-2.0
// What a program asks that has the rig as its own: frames, moves, the stage.
#include <fmt/format.h>

#include <future>
#include <memory>
#include <type_traits>
#include <utility>

#include "engine/error.hpp"
#include "hal/clock.hpp"
#include "serve/operator.hpp"
#include "session/json_line.hpp"

namespace fathom::serve {
namespace {

using std::chrono::milliseconds;

/// Longer than anything may take that is done between two looks round.
constexpr std::chrono::seconds kLongest{10};

const char* word(bool value) { return value ? "true" : "false"; }

std::string camera_facts(const Camera& camera) {
  const CameraSettings own = camera.settings();
  return JsonLine()
      .add("description", camera.description())
      .add("width", own.width_px)
      .add("height", own.height_px)
      .add("bits", static_cast<int>(own.depth))
      .add("exposure_ms", own.exposure_ms)
      .add_json("live", word(camera.is_live()))
      .add_json("streams", word(camera.streams()))
      .add("recorded_here", camera.recorded_here())
      .add("patience_ms", static_cast<double>(camera.patience().count()))
      .text();
}

std::string optics_facts(const std::optional<Optics>& optics) {
  if (!optics) return "null";
  return JsonLine()
      .add("focal_mm", optics->focal_mm)
      .add("f_number", optics->f_number)
      .add("circle_mm", optics->circle_mm)
      .text();
}

std::string names_facts(const std::vector<std::string>& names) {
  // {"":"text"} without what is not the text.
  constexpr std::size_t kKey = 3;
  std::string list;
  for (const std::string& name : names)
    list += (list.empty() ? "" : ",") + JsonLine().add("", name).body().substr(kKey);
  return "[" + list + "]";
}

std::string lens_facts(const LensInfo& lens) {
  JsonLine line;
  line.add("description", lens.description).add("unit", lens.unit);
  line.add("min", lens.lowest).add("max", lens.highest).add("step", lens.resolution);
  line.add("coarse", lens.coarse_spacing).add("stops", lens.stops);
  line.add_json("stop_names", names_facts(lens.stop_names));
  line.add_json("optics", optics_facts(lens.optics));
  lens.blur_px_per_unit ? line.add("blur_px_per_unit", *lens.blur_px_per_unit)
                        : line.add_null("blur_px_per_unit");
  return line.text();
}

}  // namespace

template <typename Work>
auto Operator::on_rig(Work work) {
  using Made = std::invoke_result_t<Work>;
  auto task = std::make_shared<std::packaged_task<Made()>>([this, work = std::move(work)] {
    if (!hardware_)
      throw Error(ErrorCode::device_lost, "the rig is not there; it is tried again every 2 s");
    return work();
  });
  std::future<Made> made = task->get_future();
  {
    const std::lock_guard lock(mutex_);
    require_idle();
    push([task] { (*task)(); });
  }
  if (made.wait_for(kLongest) != std::future_status::ready)
    throw Error(ErrorCode::timeout, "the rig is at something else that takes long");
  return made.get();
}

std::string Operator::rig_facts() {
  return on_rig([this] {
    return JsonLine()
        .add_json("camera", camera_facts(hardware_->camera()))
        .add_json("lens", lens_facts(hardware_->lens().info()))
        .add_json("stage", word(hardware_->stage() != nullptr))
        .text();
  });
}

std::optional<TakenFrame> Operator::take(milliseconds timeout) {
  return on_rig([this, timeout]() -> std::optional<TakenFrame> {
    taken_ns_ = monotonic_now_ns();
    try {
      const std::optional<Frame> frame = eyes_.camera->grab(timeout);
      if (!frame) return std::nullopt;
      return TakenFrame{.frame = frame->clone(),
                        .position = frame->lens_position,
                        .counts = eyes_.camera->counts()};
    } catch (const Error& error) {
      if (error.code() != ErrorCode::cancelled) lose(error);
      throw;
    }
  });
}

double Operator::lens_position() {
  return on_rig([this] { return hardware_->lens().position(); });
}

int Operator::begin_move(std::optional<double> position) {
  if (position)
    require_within(publisher_.board.read([](const State& state) { return state.lens; }), *position);
  const std::lock_guard lock(mutex_);
  require_idle();
  if (!move_.is_done) throw Busy("the lens is on its way already");
  const int id = move_.id + 1;
  move_ = {.id = id};
  push([this, id, position, before = stops_.load()] {
    stops_before_ = before;
    LensMove made = carry_out_move(id, position);
    const std::lock_guard guard(mutex_);
    move_ = std::move(made);
    wakes_.notify_all();
  });
  return id;
}

LensMove Operator::carry_out_move(int id, std::optional<double> to) {
  LensMove made{.id = id, .is_done = true};
  try {
    if (!hardware_) throw Error(ErrorCode::device_lost, "the rig is not there");
    made.arrival = to ? travel_to(*to) : eyes_.lens->home();
    made.recorded_here = eyes_.camera->recorded_here();
  } catch (const Error& error) {
    made.failure = error;
  }
  return made;
}

LensMove Operator::moved(int id, milliseconds timeout) {
  std::unique_lock lock(mutex_);
  if (id != move_.id || id == 0)
    throw Error(ErrorCode::bad_argument, fmt::format("{} is not the newest move", id));
  wakes_.wait_for(lock, timeout, [&] { return move_.is_done || move_.id != id; });
  if (id == move_.id) return move_;
  throw Error(ErrorCode::bad_argument, fmt::format("{} is not the newest move", id));
}

TargetStage& Operator::stage() {
  if (TargetStage* const stage = hardware_->stage()) return *stage;
  throw Error(ErrorCode::unsupported, "this rig cannot move its target");
}

double Operator::stage_distance(std::optional<std::pair<double, double>> place_px) {
  return on_rig([this, place_px] {
    return place_px ? stage().distance_mm(place_px->first, place_px->second)
                    : stage().distance_mm();
  });
}

void Operator::place_target(double distance_mm) {
  on_rig([this, distance_mm] { stage().place_at(distance_mm); });
}

}  // namespace fathom::serve
