// SPDX-License-Identifier: Apache-2.0
#include "python/stack.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "engine/error.hpp"
#include "hal/camera_settings.hpp"
#include "hal/drivers/replay/spacing.hpp"
#include "python/errors.hpp"

namespace fathom::python {
namespace {

/// How long a move and an exposure last on the stack's clock, which only orders events.
constexpr std::int64_t kTick_ns = 1'000'000;

/// Made with Python's lock held, and used without it.
struct Stack {
  Pictures pictures;
  std::string unit;
  std::vector<double> positions = {};                // increasing, each once
  std::vector<std::vector<std::size_t>> taken = {};  // at each of them
  std::size_t current = 0, turn = 0;
  std::int64_t now_ns = 0;

  std::string description() const {
    return fmt::format("a stack of {} pictures of {} x {} px", pictures.size(), pictures.width_px(),
                       pictures.height_px());
  }
};

/// The last of camera and lens lets go of the array, in whatever thread that is.
void let_go(Stack* stack) {
  const py::gil_scoped_acquire lock;
  delete stack;
}

void group(Stack& stack, const std::vector<double>& positions) {
  std::vector<std::size_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return positions[i]; });
  for (const std::size_t i : order) {
    if (stack.positions.empty() || stack.positions.back() != positions[i]) {
      stack.positions.push_back(positions[i]);
      stack.taken.emplace_back();
    }
    stack.taken.back().push_back(i);
  }
}

class StackCamera final : public Camera {
 public:
  explicit StackCamera(std::shared_ptr<Stack> stack) : stack_(std::move(stack)) {}

  std::string description() const override { return stack_->description(); }
  CameraSettings settings() const override {
    return {stack_->pictures.width_px(), stack_->pictures.height_px(), stack_->pictures.depth(), 0};
  }
  Validity validate(CameraSettings& wished) const override { return adjust(wished, settings()); }
  void apply(const CameraSettings& wished) override {
    if (wished != settings()) throw Error(ErrorCode::unsupported, "a stack is what it is");
  }
  bool is_live() const override { return false; }
  int recorded_here() const override { return static_cast<int>(here().size()); }

  std::optional<Frame> grab(std::chrono::milliseconds) override {
    Frame frame = stack_->pictures.frame(here()[stack_->turn++ % here().size()]);
    frame.exposure.start_ns = stack_->now_ns;
    frame.exposure.end_ns = stack_->now_ns += kTick_ns;
    frame.lens_position = stack_->positions[stack_->current];
    return frame;
  }

 private:
  const std::vector<std::size_t>& here() const { return stack_->taken[stack_->current]; }

  std::shared_ptr<Stack> stack_;
};

class StackLens final : public Lens {
 public:
  explicit StackLens(std::shared_ptr<Stack> stack)
      : stack_(std::move(stack)),
        info_({.description = stack_->description(),
               .unit = stack_->unit,
               .lowest = stack_->positions.front(),
               .highest = stack_->positions.back(),
               .resolution = replay::smallest_gap(stack_->positions),
               .coarse_spacing = replay::coarse_spacing_of(stack_->positions),
               .stops = stack_->positions}) {}

  LensInfo info() const override { return info_; }

  double position() const override { return stack_->positions[stack_->current]; }

  Arrival move_to(double position) override {
    require_within(info_, position);
    const auto at = std::ranges::lower_bound(stack_->positions, nearest(position));
    stack_->current = static_cast<std::size_t>(at - stack_->positions.begin());
    stack_->turn = 0;
    const std::int64_t started_ns = stack_->now_ns;
    const std::int64_t rest_ns = stack_->now_ns += kTick_ns;
    return {
        .position = *at, .started_ns = started_ns, .stopped_ns = rest_ns, .settled_ns = rest_ns};
  }

  Arrival home() override { return move_to(stack_->positions.front()); }
  std::string why_unwatched() const override {
    return "a stack has no pictures between two others";
  }

 private:
  std::shared_ptr<Stack> stack_;
  LensInfo info_;  // asked for at every move
};

}  // namespace

Hardware stack_hardware(Pictures pictures, std::vector<double> positions, std::string unit) {
  if (!pictures.is_stack()) refuse("stack has 2 axes; a stack has 3: pictures, rows, columns");
  if (positions.size() != pictures.size()) {
    refuse(fmt::format("positions holds {} of them, and stack {} pictures", positions.size(),
                       pictures.size()));
  }
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!std::isfinite(positions[i])) refuse(fmt::format("positions[{}] is no finite number", i));
  }
  const std::shared_ptr<Stack> stack(new Stack{std::move(pictures), std::move(unit)}, let_go);
  group(*stack, positions);
  return {.camera = std::make_unique<StackCamera>(stack),
          .lens = std::make_unique<StackLens>(stack),
          .stage = nullptr};
}

}  // namespace fathom::python
