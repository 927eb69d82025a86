// SPDX-License-Identifier: Apache-2.0
// A selected device, a plan and the windows that it scores: what every measurement puts together.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "backend.hpp"
#include "selection.hpp"
#include "window.hpp"

namespace fathom {

/// Windows of one side: a list, or a grid that is never written out.
class Windows {
 public:
  Windows(const Window& one) : Windows(std::vector{one}) {}
  Windows(std::vector<Window> list) : windows_(std::move(list)) {}
  Windows(const WindowGrid& grid) : windows_(grid) {}

  std::size_t size() const {
    return std::visit([](const auto& windows) { return windows.size(); }, windows_);
  }
  /// i < size(), unchecked.
  Window operator[](std::size_t i) const {
    return std::visit([i](const auto& windows) -> Window { return windows[i]; }, windows_);
  }

 private:
  std::variant<std::vector<Window>, WindowGrid> windows_;
};

/// Windows of side n that fill any device, whose pixels (16 Mi at most) and values take little
/// memory.
std::size_t full_batch(int n);

/// Scores the same windows of frame after frame, by one metric on one device.
class Scorer {
 public:
  /// Takes the device and makes its plan, for full_batch() windows a call at most, however many
  /// there are. Throws as Device::plan, and Error(bad_argument) where there is no window.
  Scorer(Selection selection, const MetricSpec& spec, Windows windows);

  /// The same for windows that come with each frame, `batch` of them at most.
  Scorer(Selection selection, const MetricSpec& spec, std::size_t batch);

  const MetricSpec& spec() const { return plan_->spec(); }
  const Selection& selection() const { return selection_; }
  const Windows& windows() const { return windows_; }
  /// Numbers that one window gives.
  std::size_t outputs() const { return spec().outputs(); }
  /// Most windows that the device takes at once.
  std::size_t batch() const { return plan_->capacity(); }

  /// The numbers of every window, window by window: values.size() == windows().size() * outputs().
  /// Throws as Plan::score.
  void score(const Frame& frame, std::span<double> values);

  /// Those of the windows from number `first` on, as many as there is room for: for callers who
  /// show progress. Throws as Plan::score, Error(out_of_bounds) for windows that are not there.
  void score(const Frame& frame, std::size_t first, std::span<double> values);

  /// The only number of the first window. Throws as Plan::score.
  double score(const Frame& frame) { return plan_->score(frame, windows_[0]); }

  /// The numbers of other windows, at most batch(): for callers who are told them with each frame.
  /// Throws as Plan::score.
  void score(const Frame& frame, std::span<const Window> windows, std::span<double> values) {
    plan_->score(frame, windows, values);
  }

  /// Other windows of the same side, as in a picture of another size. Throws Error(bad_argument)
  /// where there is none.
  void aim(Windows windows);

 private:
  Selection selection_;  // its device outlives the plan
  std::unique_ptr<Plan> plan_;
  Windows windows_ = std::vector<Window>();
  std::vector<Window> batches_[2];  ///< Of the two calls in flight.
};

}  // namespace fathom
