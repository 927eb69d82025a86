// SPDX-License-Identifier: Apache-2.0
#include "engine/scorer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "engine/error.hpp"

namespace fathom {
namespace {

void require_windows(const Windows& windows) {
  if (windows.size() == 0) throw Error(ErrorCode::bad_argument, "there is no window to score");
}

/// Waits for the batch before this one, also where an error ends the call: a device must not write
/// into what its caller has given up.
class InFlight {
 public:
  explicit InFlight(Plan& plan) : plan_(plan) {}
  InFlight(const InFlight&) = delete;
  InFlight& operator=(const InFlight&) = delete;
  ~InFlight() {
    try {
      land();
    } catch (const Error&) {  // an earlier one is on its way
    }
  }

  void start(Plan::Ticket ticket) {
    const auto before = std::exchange(ticket_, ticket);
    if (before) plan_.wait(*before);
  }
  void land() {
    if (const auto last = std::exchange(ticket_, std::nullopt)) plan_.wait(*last);
  }

 private:
  Plan& plan_;
  std::optional<Plan::Ticket> ticket_;
};

}  // namespace

std::size_t full_batch(int n) {
  constexpr std::size_t kMostWindows = 4096, kMostPixels = std::size_t{1} << 24;
  return std::min(kMostWindows, kMostPixels / (static_cast<std::size_t>(n) * n));
}

Scorer::Scorer(Selection selection, const MetricSpec& spec, std::size_t batch)
    : selection_(std::move(selection)), plan_(selection_.device->plan(spec, batch)) {}

Scorer::Scorer(Selection selection, const MetricSpec& spec, Windows windows)
    : Scorer(std::move(selection), spec,
             std::clamp<std::size_t>(windows.size(), 1, full_batch(spec.n))) {
  aim(std::move(windows));
}

void Scorer::score(const Frame& frame, std::span<double> values) {
  if (values.size() != windows_.size() * outputs()) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("{} windows of {} values each, but room for {} values", windows_.size(),
                            outputs(), values.size()));
  }
  score(frame, 0, values);
}

void Scorer::score(const Frame& frame, std::size_t first, std::span<double> values) {
  const std::size_t count = values.size() / outputs();
  if (first > windows_.size() || count > windows_.size() - first) {
    throw Error(ErrorCode::out_of_bounds,
                fmt::format("windows {} to {} of {}", first, first + count, windows_.size()));
  }
  // While a device computes one batch, the next is put together.
  InFlight in_flight(*plan_);
  for (std::size_t done = 0, turn = 0; done < count; ++turn) {
    std::vector<Window>& windows = batches_[turn % 2];
    const std::size_t size = std::min(batch(), count - done);
    windows.clear();
    for (std::size_t i = 0; i < size; ++i) windows.push_back(windows_[first + done + i]);
    in_flight.start(
        plan_->submit(frame, windows, values.subspan(done * outputs(), size * outputs())));
    done += size;
  }
  in_flight.land();
}

void Scorer::aim(Windows windows) {
  require_windows(windows);
  windows_ = std::move(windows);
  for (auto& batch_windows : batches_) batch_windows.reserve(std::min(batch(), windows_.size()));
}

}  // namespace fathom
