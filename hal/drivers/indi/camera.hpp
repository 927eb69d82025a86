// SPDX-License-Identifier: Apache-2.0
// A camera on an INDI server.
//
// grab() begins an exposure where none is running, so that a frame's exposure never began before it
// was asked for; one that an impatient grab began is collected by the next. A frame's start is the
// time of the request and a little early; its end is when the picture was here, and late by the
// readout.
//
// What another program exposes, and what could not be aborted, is waited out before an exposure is
// asked for, and its picture is not taken.
//
// A camera that knows its size only once it has taken a picture, such as a DSLR, takes one when it
// is opened.
//
// While it is open it takes pictures of light in FITS, uncompressed, sent to the client; what it
// found is put back. A device found disconnected is connected and stays so: disconnecting resets
// much (coolers, motors), and it may be a focuser as well.
#pragma once

#include <memory>
#include <string>

#include "hal/camera.hpp"
#include "hal/drivers/indi/changes.hpp"
#include "hal/drivers/indi/settings.hpp"

namespace fathom::indi {

class IndiCamera final : public Camera {
 public:
  /// `device` must be connected. Throws Error(unavailable) if it is exposing for somebody else,
  /// Error(unsupported) for wishes that it cannot keep, Error(timeout), Error(bad_data).
  IndiCamera(std::unique_ptr<Client> client, std::string device, const IndiSettings& settings,
             StopRequests stop_requests);
  ~IndiCamera() override;

  std::string description() const override;
  CameraSettings settings() const override { return settings_; }
  Validity validate(CameraSettings& wished) const override;
  void apply(const CameraSettings& settings) override;
  bool is_live() const override { return true; }
  /// As long as an answer may take, and a little, so that grab() can say what is wrong first.
  std::chrono::milliseconds patience() const override {
    return std::chrono::ceil<std::chrono::milliseconds>(
               std::chrono::nanoseconds(client_->timeout_ns())) +
           std::chrono::seconds(1);
  }
  FrameCounts counts() const override { return counts_; }
  std::optional<Frame> grab(std::chrono::milliseconds timeout) override;

 private:
  double number(const std::string& property, const std::string& value) const;
  int count(const std::string& property, const std::string& value, int fallback) const;
  bool knows_its_size() const;
  void learn_its_size(double exposure_ms);
  void read_limits();
  void read_chip();
  void prepare(const IndiSettings& settings);
  void wish_frame(const CameraWishes& wishes);
  void wish_gain(double gain);
  void set_frame(double x, double y, double width, double height);
  void read_frame();
  void apply_size(int width_px, int height_px);

  bool is_idle();
  void drop_picture();
  bool await_idle(std::int64_t deadline_ns, const StopWatch& stop);
  void begin_exposure();
  bool is_over();
  std::int64_t overdue_ns() const;
  void abort_exposure();
  std::optional<Frame> take_picture();
  std::optional<Frame> expose(std::chrono::milliseconds timeout);

  std::unique_ptr<Client> client_;
  std::string device_;
  StopRequests stop_requests_;
  Changes changes_;  // after the client, which it needs to put things back

  int chip_width_px_ = 0;
  int chip_height_px_ = 0;
  int bin_x_ = 1;
  int bin_y_ = 1;
  double shortest_ms_ = 0;
  double longest_ms_ = 0;
  CameraSettings settings_;
  FrameCounts counts_;

  bool is_exposing_ = false;
  std::int64_t started_ns_ = 0;
  std::uint64_t started_serial_ = 0;   // of CCD_EXPOSURE
  std::int64_t busy_since_ns_ = 0;     // with an exposure that is not to be had, or 0
  std::int64_t runs_on_until_ns_ = 0;  // one of ours that could not be aborted, at the latest
  bool is_picture_due_ = false;        // of an exposure that is not to be had
  int damaged_in_a_row_ = 0;
  std::string lost_;  // why it must be opened again
};

}  // namespace fathom::indi
