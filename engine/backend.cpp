// SPDX-License-Identifier: Apache-2.0
#include "engine/backend.hpp"

#include <fmt/format.h>

#include "engine/error.hpp"
#include "engine/spectra_plan.hpp"

namespace fathom {

void Plan::require_window(const Frame& frame, const Window& window) const {
  if (window.n != spec_.n) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("a plan for {} takes windows of side {}, not {}", spec_.text(), spec_.n,
                            window.n));
  }
  require_fits(window, frame.width_px(), frame.height_px());
}

std::uint64_t Plan::submit_checked(const Frame& frame, std::span<const Window> windows,
                                   std::span<double> values) {
  if (frame.empty()) throw Error(ErrorCode::bad_argument, "cannot score an empty frame");
  if (windows.size() > capacity_) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("{} windows in one call, but the plan's capacity is {}", windows.size(),
                            capacity_));
  }
  if (values.size() != windows.size() * outputs_) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("{} windows of {} values each, but room for {} values", windows.size(),
                            outputs_, values.size()));
  }
  const int last_x = frame.width_px() - spec_.n, last_y = frame.height_px() - spec_.n;
  for (const Window& window : windows) {
    // Inline, because a small window is scored in the time of some calls.
    const bool fits = window.n == spec_.n && window.x >= 0 && window.y >= 0 && window.x <= last_x &&
                      window.y <= last_y;
    if (!fits) require_window(frame, window);
  }
  const std::uint64_t ticket = ++last_ticket_;
  do_submit(ticket, frame, windows, values);
  return ticket;
}

Plan::Ticket Plan::submit(const Frame& frame, std::span<const Window> windows,
                          std::span<double> values) {
  const OneThread::Inside inside(door_);
  return {submit_checked(frame, windows, values)};
}

void Plan::wait(Ticket ticket) {
  const OneThread::Inside inside(door_);
  if (ticket.number == 0 || ticket.number > last_ticket_) {
    throw Error(ErrorCode::bad_argument, "waiting for a batch that was never submitted");
  }
  do_wait(ticket.number);
}

void Plan::score(const Frame& frame, std::span<const Window> windows, std::span<double> values) {
  const OneThread::Inside inside(door_);
  do_wait(submit_checked(frame, windows, values));
}

double Plan::score(const Frame& frame, const Window& window) {
  if (outputs_ != 1) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("{} gives {} values of a window, not one", spec_.text(), outputs_));
  }
  double result = 0;
  score(frame, {&window, 1}, {&result, 1});
  return result;
}

void Plan::spectrum(const Frame& frame, const Window& window,
                    std::span<std::complex<double>> coefficients) {
  const OneThread::Inside inside(door_);
  if (frame.empty()) throw Error(ErrorCode::bad_argument, "an empty frame has no spectrum");
  require_window(frame, window);
  const std::size_t wanted = static_cast<std::size_t>(spec_.n) * spec_.n;
  if (coefficients.size() != wanted) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("a spectrum has {} coefficients, not {}", wanted, coefficients.size()));
  }
  do_spectrum(frame, window, coefficients);
}

const char* to_string(DeviceKind kind) noexcept {
  switch (kind) {
    case DeviceKind::cpu:
      return "cpu";
    case DeviceKind::gpu:
      return "gpu";
    case DeviceKind::software:
      return "software";
  }
  return "unknown";
}

std::unique_ptr<Plan> Device::plan(const MetricSpec& spec, std::size_t capacity) {
  spec.validate();
  if (capacity == 0)
    throw Error(ErrorCode::bad_argument, "a plan needs room for at least one window");
  if (const std::string reason = unsupported(spec); !reason.empty()) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{} cannot compute {}: {}", info_.name, spec.text(), reason));
  }
  if (fuses(spec)) return do_plan(spec, capacity);
  return plan_from_spectra(do_plan(spec.plain(), 1), spec, capacity);
}

std::string Device::unsupported(const MetricSpec& spec) const {
  return do_unsupported(fuses(spec) ? spec : spec.plain());
}

}  // namespace fathom
