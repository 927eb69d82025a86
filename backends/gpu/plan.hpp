// SPDX-License-Identifier: Apache-2.0
// The life of a plan on a device with memory and a queue of its own:
//
//   made:    programs (a fast one for 8 bits, an exact one for what it is not sure of), two flights
//   submit:  cut the call into batches whose pixels fit a buffer; for each: wait until the older
//            flight has landed, copy the pixels once, start copy and kernels, go on without waiting
//   wait:    land the ticket's flights: scores from the device's units to the metric's
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "backends/gpu/batch.hpp"
#include "backends/gpu/constants.hpp"
#include "backends/gpu/results.hpp"
#include "backends/gpu/spectrum.hpp"
#include "backends/gpu/tables.hpp"
#include "backends/gpu/wait_limit.hpp"
#include "engine/backend.hpp"
#include "engine/error.hpp"
#include "engine/process.hpp"

namespace fathom::gpu {

/// Values of one batch: enough to fill any GPU, and their lists stay small beside a frame.
inline constexpr std::size_t kMostValues = 1U << 20;
/// Windows that are scored again at a time; the rest, rarely any, wait for their scratch memory.
inline constexpr std::size_t kDoubtful = 256;
/// Byte offsets of pixels are 32 bits.
inline constexpr std::uint64_t kMostPixelBytes = 1U << 31;

/// A plan on an opened device, which it keeps open. Submitting allocates on the device only for a
/// frame larger than all before, and compiles only for the first of 16 bits. All throw
/// Error(out_of_memory), Error(device_lost) and Error(timeout) (wait_limit.hpp).
///
/// Context   an opened device: limits(), require_alive(), drain() noexcept, is_given_up()
/// Program   a kernel made ready for a metric: Program(Context&, spec, Shape, Depth, most windows),
///           shape(), prepare(Wanted)
/// Flight    a batch on its way through the device: Flight(Context&, most windows, words of each),
///           load(frame, Rectangle, windows, ids), start(program, rescue or null, args, Wanted),
///           finish(), results(): words, window by window, coefficients(): words of a spectrum
template <class Context, class Program, class Flight>
class FlightPlan final : public Plan {
 public:
  FlightPlan(std::shared_ptr<Context> context, const MetricSpec& spec, std::size_t capacity)
      : Plan(spec, capacity), context_(std::move(context)), results_(spec), args_(args_for(spec)) {
    const std::size_t batch = most_windows();
    if (!needs_exact(spec)) make_fast(fast8_, Depth::bits8);
    if (may_need_exact(spec)) {
      exact_.emplace(*context_, spec, *exact_shape(spec, limits()), Depth::bits8,
                     needs_exact(spec) ? batch : std::min(batch, kDoubtful));
    }
    for (Seat& seat : seats_) {
      seat.flight = std::make_unique<Flight>(*context_, batch, results_.words());
    }
  }

  ~FlightPlan() override {
    if (forks() != made_in_) {  // all that is left here are copies of handles
      abandon();
      return;
    }
    for (Seat& seat : seats_) {
      seat.values = {};
      try {
        land(seat);
      } catch (const std::exception&) {
        context_->drain();  // before what the device may still use goes
      }
    }
    if (context_->is_given_up()) abandon();
  }

 private:
  static constexpr std::uint64_t kNoTicket = std::numeric_limits<std::uint64_t>::max();

  /// A flight and where its batch came from.
  struct Seat {
    std::unique_ptr<Flight> flight;
    bool is_aloft = false;
    std::uint64_t ticket = 0;
    std::span<double> values;        ///< Of the whole call; empty: nobody wants them any more.
    std::vector<std::uint32_t> ids;  ///< Which of the call's windows; empty: all, in order.
  };

  void require_own_process() const {
    if (forks() == made_in_) return;
    throw Error(ErrorCode::device_lost,
                "this process was forked after the plan was made, and the device serves its parent "
                "only; fork first, then open a device in each process");
  }

  void do_submit(std::uint64_t ticket, const Frame& frame, std::span<const Window> windows,
                 std::span<double> values) override {
    require_own_process();
    context_->require_alive();
    if (windows.empty()) return;
    // A frame's buffer may hold its list of windows too (kernels/args.h).
    const std::size_t list = 4 * std::min(windows.size(), most_windows());
    const std::size_t most = std::min(limits().buffer_bytes, kMostPixelBytes);
    const std::size_t room = most - std::min(most / 2, list);
    Rectangle all;
    for (const Window& window : windows) all.include(window);
    try {
      if (all.bytes(frame.depth()) <= room && windows.size() <= most_windows()) {
        return take_off(ticket, frame, {all, {}}, windows, values);
      }
      for (auto& batch : cut(windows, frame.depth(), most_windows(), room)) {
        take_off(ticket, frame, std::move(batch), windows, values);
      }
    } catch (...) {
      // The caller hears of no ticket, so nobody waits before the values go.
      for (Seat& seat : seats_) {
        if (seat.ticket == ticket) seat.values = {};
      }
      throw;
    }
  }

  void take_off(std::uint64_t ticket, const Frame& frame, Batch batch,
                std::span<const Window> windows, std::span<double> values) {
    Seat& seat = seats_[oldest_];
    land(seat);
    seat.flight->load(frame, batch.part, windows, batch.ids);
    Program& program = program_for(frame.depth());
    seat.flight->start(program, rescue_of(program), args_, Wanted::score);
    seat.is_aloft = true;
    seat.ticket = ticket;
    seat.values = values;
    seat.ids = std::move(batch.ids);
    oldest_ = 1 - oldest_;
  }

  void do_wait(std::uint64_t ticket) override {
    require_own_process();
    for (const std::size_t i : {oldest_, 1 - oldest_}) {
      if (seats_[i].ticket <= ticket) land(seats_[i]);
    }
    if (ticket >= first_lost_) context_->require_alive();
  }

  void land(Seat& seat) {
    if (!seat.is_aloft) return;
    try {
      seat.flight->finish();
    } catch (const Error& error) {
      context_->drain();  // the device may be at it still
      if (error.code() == ErrorCode::device_lost || error.code() == ErrorCode::timeout) {
        seat.is_aloft = false;
        first_lost_ = std::min(first_lost_, seat.ticket);
      }
      throw;
    }
    seat.is_aloft = false;
    if (seat.values.empty()) return;
    const std::uint32_t* words = seat.flight->results();
    const std::size_t outputs = spec().outputs();
    const std::size_t count = seat.ids.empty() ? seat.values.size() / outputs : seat.ids.size();
    for (std::size_t i = 0; i < count; ++i, words += results_.words()) {
      const std::size_t window = seat.ids.empty() ? i : seat.ids[i];
      results_.read(words, seat.values.subspan(window * outputs, outputs));
    }
  }

  /// The device may still use all that it was given.
  void abandon() {
    for (Seat& seat : seats_) keep_for_ever(std::move(seat.flight));
    for (auto* program : {&fast8_, &fast16_, &exact_}) {
      if (*program) keep_for_ever(std::make_shared<Program>(std::move(**program)));
    }
    keep_for_ever(context_);
  }

  void do_spectrum(const Frame& frame, const Window& window,
                   std::span<std::complex<double>> coefficients) override {
    require_own_process();
    context_->require_alive();
    Seat& seat = seats_[oldest_];
    land(seat);
    Program& program = program_for(frame.depth());
    program.prepare(Wanted::coefficients);
    Rectangle part;
    part.include(window);
    seat.flight->load(frame, part, {&window, 1}, {});
    seat.flight->start(program, nullptr, args_, Wanted::coefficients);
    seat.is_aloft = true;
    seat.ticket = kNoTicket;
    seat.values = {};
    land(seat);
    arrange_spectrum(spec(), program.shape().kernel, frame.depth(), seat.flight->coefficients(),
                     coefficients);
  }

  const Limits& limits() const { return context_->limits(); }
  std::size_t most_windows() const { return std::min(capacity(), kMostValues / spec().outputs()); }

  void make_fast(std::optional<Program>& program, Depth depth) {
    program.emplace(*context_, spec(), *fast_shape(spec(), depth, limits()), depth, most_windows());
  }

  /// A plan's first 16-bit frame compiles what most plans never need.
  Program& program_for(Depth depth) {
    if (!fast8_) return *exact_;
    if (depth == Depth::bits8) return *fast8_;
    if (!fast16_) make_fast(fast16_, depth);
    return *fast16_;
  }

  /// What scores again where the program is in doubt.
  const Program* rescue_of(const Program& program) const {
    return exact_ && &program != &*exact_ ? &*exact_ : nullptr;
  }

  const unsigned made_in_ = forks();
  std::shared_ptr<Context> context_;
  Results results_;
  kernels::ScoreArgs args_;  ///< What is the same for every batch.
  std::optional<Program> fast8_, fast16_, exact_;
  std::array<Seat, 2> seats_;
  std::uint64_t first_lost_ = kNoTicket;  ///< The first ticket without scores.
  std::size_t oldest_ = 0;                ///< The seat whose flight took off first, or is free.
};

}  // namespace fathom::gpu
