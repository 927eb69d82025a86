// SPDX-License-Identifier: Apache-2.0
// A camera of an Alpaca server: each picture is exposed when it is asked for.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "engine/error.hpp"
#include "hal/camera.hpp"
#include "hal/drivers/alpaca/image.hpp"
#include "hal/drivers/alpaca/settings.hpp"
#include "hal/restorer.hpp"
#include "hal/stop.hpp"

namespace fathom::alpaca {

class AlpacaCamera final : public Camera {
 public:
  /// device: "camera/0". Throws as Connection, Error(unsupported) for what the camera cannot keep.
  AlpacaCamera(std::unique_ptr<Connection> connection, std::string device, const CameraKeys& keys,
               StopRequests stop_requests);
  ~AlpacaCamera() override;

  std::string description() const override;
  CameraSettings settings() const override { return settings_; }
  Validity validate(CameraSettings& wished) const override;
  void apply(const CameraSettings& settings) override;
  bool is_live() const override { return true; }
  std::chrono::milliseconds patience() const override;
  FrameCounts counts() const override { return counts_; }
  std::optional<Frame> grab(std::chrono::milliseconds timeout) override;

 private:
  double number(const char* property) const { return connection_->number(device_, property); }
  int whole(const char* property) const;
  void put(const char* property, double value) const;
  void put_and_restore(const char* property, double value);
  void connect();
  void set_up(const CameraKeys& keys);
  void set_binning(int binning);
  void set_region(const CameraKeys& keys);
  void set_side(const char* start, const char* length, int most, std::optional<int> from,
                std::optional<int> count);
  void learn_exposures(const CameraKeys& keys);
  std::optional<Frame> expose(std::chrono::milliseconds timeout);
  void begin_exposure();
  bool is_ready();
  void abort_exposure() noexcept;
  std::optional<Frame> take_picture();
  void require_in_time();

  std::unique_ptr<Connection> connection_;
  std::string device_;
  StopRequests stop_requests_;
  std::string name_;
  CameraSettings settings_;
  double shortest_ms_ = 0, longest_ms_ = 0;
  int widest_px_ = 0, highest_px_ = 0;
  std::optional<std::int64_t> exposing_since_ns_;
  FrameCounts counts_;
  int damaged_in_a_row_ = 0;
  std::optional<Error> loss_;
  Restorer restorer_;  ///< The first to go: it needs the connection.
};

}  // namespace fathom::alpaca
