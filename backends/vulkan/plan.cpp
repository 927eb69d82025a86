// SPDX-License-Identifier: Apache-2.0
// The life of a plan on Vulkan:
//
//   made:    programs (a fast one for 8 bits, an exact one for what it is not sure of), two flights
//   submit:  cut the call into batches whose pixels fit a buffer; for each: wait until the older
//            flight has landed, copy the pixels once, start copy and kernels, go on without waiting
//   wait:    land the ticket's flights: scores from the device's units to the metric's
#include "backends/vulkan/plan.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <optional>

#include "backends/gpu/spectrum.hpp"
#include "backends/gpu/tables.hpp"
#include "backends/vulkan/flight.hpp"
#include "engine/error.hpp"
#include "engine/tables.hpp"

namespace fathom::vulkan {
namespace {

/// Windows of one batch: enough to fill any GPU, and their lists stay small beside a frame.
constexpr std::size_t kMostWindows = 1U << 20;
/// Windows that are scored again at a time; the rest, rarely any, wait for their scratch memory.
constexpr std::size_t kDoubtful = 256;
/// Byte offsets of pixels are 32 bits.
constexpr std::uint64_t kMostPixelBytes = 1U << 31;

class VulkanPlan final : public Plan {
 public:
  VulkanPlan(std::shared_ptr<Context> context, const MetricSpec& spec, std::size_t capacity)
      : Plan(spec, capacity), context_(std::move(context)), scale_(tables::moment_scale(spec)) {
    const std::size_t batch = most_windows();
    if (!gpu::needs_exact(spec)) make_fast(fast8_, Depth::bits8);
    if (gpu::needs_exact(spec) || !is_walsh(spec.transform)) {
      exact_.emplace(*context_, spec, *gpu::exact_shape(spec, limits()), Depth::bits8,
                     gpu::needs_exact(spec) ? batch : std::min(batch, kDoubtful));
    }
    for (Seat& seat : seats_) seat.flight = std::make_unique<Flight>(*context_, batch);
    gpu::set_doubt(args_, spec);
    const gpu::SquaredRadii radii = gpu::band_radii(spec);
    args_.band_above = radii.above;
    args_.band_to = radii.to;
  }

  ~VulkanPlan() override {
    for (Seat& seat : seats_) {
      seat.scores = {};
      try {
        land(seat);
      } catch (const std::exception&) {
        context_->drain();  // before what the device may still use goes
      }
    }
  }

 private:
  /// A flight and where its batch came from.
  struct Seat {
    std::unique_ptr<Flight> flight;
    bool is_aloft = false;
    std::uint64_t ticket = 0;
    std::span<double> scores;        ///< Of the whole call; empty: nobody wants them any more.
    std::vector<std::uint32_t> ids;  ///< Which of the call's windows; empty: all, in order.
  };

  void do_submit(std::uint64_t ticket, const Frame& frame, std::span<const Window> windows,
                 std::span<double> scores) override {
    context_->require_alive();
    if (windows.empty()) return;
    const std::size_t room = std::min(limits().buffer_bytes, kMostPixelBytes);
    gpu::Rectangle all;
    for (const Window& window : windows) all.include(window);
    try {
      if (all.bytes(frame.depth()) <= room && windows.size() <= kMostWindows) {
        return take_off(ticket, frame, {all, {}}, windows, scores);
      }
      for (auto& batch : gpu::cut(windows, frame.depth(), kMostWindows, room)) {
        take_off(ticket, frame, std::move(batch), windows, scores);
      }
    } catch (...) {
      // The caller hears of no ticket, so nobody waits before the scores go.
      for (Seat& seat : seats_) {
        if (seat.ticket == ticket) seat.scores = {};
      }
      throw;
    }
  }

  void take_off(std::uint64_t ticket, const Frame& frame, gpu::Batch batch,
                std::span<const Window> windows, std::span<double> scores) {
    Seat& seat = seats_[oldest_];
    land(seat);
    seat.flight->load(frame, batch.part, windows, batch.ids);
    Program& program = program_for(frame.depth());
    seat.flight->start(program, rescue_of(program), args_, nullptr);
    seat.is_aloft = true;
    seat.ticket = ticket;
    seat.scores = scores;
    seat.ids = std::move(batch.ids);
    oldest_ = 1 - oldest_;
  }

  void do_wait(std::uint64_t ticket) override {
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
      if (error.code() == ErrorCode::device_lost) {
        seat.is_aloft = false;
        first_lost_ = std::min(first_lost_, seat.ticket);
      }
      throw;
    }
    seat.is_aloft = false;
    if (seat.scores.empty()) return;
    const std::uint32_t* const results = seat.flight->results();
    const std::size_t count = seat.ids.empty() ? seat.scores.size() : seat.ids.size();
    for (std::size_t i = 0; i < count; ++i) {
      seat.scores[seat.ids.empty() ? i : seat.ids[i]] = scale_ * moment(results + 2 * i);
    }
  }

  /// SUM m r^2 as a kernel gives it: an integer of 64 bits, low word first, or a sum of two floats.
  double moment(const std::uint32_t* words) const {
    if (spec().is_exact()) {
      return static_cast<double>(std::uint64_t{words[1]} << 32 | words[0]);
    }
    return double{std::bit_cast<float>(words[0])} + double{std::bit_cast<float>(words[1])};
  }

  void do_spectrum(const Frame& frame, const Window& window,
                   std::span<std::complex<double>> coefficients) override {
    context_->require_alive();
    Seat& seat = seats_[oldest_];
    land(seat);
    Program& program = program_for(frame.depth());
    program.prepare(Program::Wanted::coefficients);
    const Buffer raw = context_->buffer(sizeof(std::uint32_t) * gpu::spectrum_words(spec().n),
                                        Place::device_written, "a spectrum");
    gpu::Rectangle part;
    part.include(window);
    seat.flight->load(frame, part, {&window, 1}, {});
    seat.flight->start(program, nullptr, args_, &raw);
    try {
      seat.flight->finish();
    } catch (...) {
      context_->drain();  // before `raw` goes
      throw;
    }
    gpu::arrange_spectrum(spec(), program.shape().kernel, frame.depth(),
                          static_cast<const std::uint32_t*>(raw.mapped), coefficients);
  }

  const gpu::Limits& limits() const { return context_->physical().limits; }
  std::size_t most_windows() const { return std::min(capacity(), kMostWindows); }

  void make_fast(std::optional<Program>& program, Depth depth) {
    program.emplace(*context_, spec(), *gpu::fast_shape(spec(), depth, limits()), depth,
                    most_windows());
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

  std::shared_ptr<Context> context_;
  double scale_;
  kernels::ScoreArgs args_ = {};  ///< What is the same for every batch.
  std::optional<Program> fast8_, fast16_, exact_;
  std::array<Seat, 2> seats_;
  std::uint64_t first_lost_ =
      std::numeric_limits<std::uint64_t>::max();  ///< Ticket without scores.
  std::size_t oldest_ = 0;  ///< The seat whose flight took off first, or is free.
};

}  // namespace

std::unique_ptr<Plan> make_plan(std::shared_ptr<Context> context, const MetricSpec& spec,
                                std::size_t capacity) {
  return std::make_unique<VulkanPlan>(std::move(context), spec, capacity);
}

}  // namespace fathom::vulkan
