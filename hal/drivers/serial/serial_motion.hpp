// SPDX-License-Identifier: Apache-2.0
// A move of a device on a serial port, which goes on by itself; whoever asks how it stands has it asked.
#pragma once

#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <utility>

#include "hal/drivers/serial/serial_lens.hpp"
#include "hal/drivers/serial/track.hpp"
#include "hal/motion.hpp"

namespace fathom::serial {

/// What goes on between a trip's beginning and its end. All calls are as in Motion.
class Voyage {
 public:
  /// Begins the first leg. `lens` must outlive this. Throws what the device says against it.
  Voyage(SerialLens& lens, Trip trip);
  Voyage(const Voyage&) = delete;
  Voyage& operator=(const Voyage&) = delete;
  ~Voyage();

  void stop() { wishes_stop_ = true; }
  std::optional<Arrival> arrived();
  Arrival wait();
  Where during(const Exposure& exposure);

  bool is_over() const { return is_over_; }

 private:
  void begin_leg();
  /// Asks once, and does what follows from it.
  void advance();
  void heed(const Look& look);
  bool is_at_rest(const Look& look, std::int64_t now_ns);
  void heed_progress(const Look& look, std::int64_t now_ns);
  void halt_if_wished();
  void end_leg();
  void finish(bool was_halted);
  void fail() noexcept;
  [[noreturn]] void fail_stalled(std::int64_t now_ns);

  SerialLens& lens_;
  Trip trip_;
  std::size_t leg_ = 0;
  int goal_ = 0;  // of the leg, in steps
  Track track_;
  Arrival arrival_;
  bool is_over_ = false, wishes_stop_ = false, is_halted_ = false;
  std::exception_ptr problem_;
  double said_ = 0, least_ = 0, quantum_ = 0;
  std::int64_t began_ns_ = 0, progress_ns_ = 0, unchanged_since_ns_ = 0;
};

class SerialMotion final : public Motion {
 public:
  SerialMotion(SerialLens& lens, Trip trip)
      : voyage_(std::make_unique<Voyage>(lens, std::move(trip))) {}

  void stop() override { voyage_->stop(); }
  std::optional<Arrival> arrived() override { return voyage_->arrived(); }
  Arrival wait() override { return voyage_->wait(); }

 private:
  Where do_during(const Exposure& exposure) const override { return voyage_->during(exposure); }

  std::unique_ptr<Voyage> voyage_;
};

}  // namespace fathom::serial
