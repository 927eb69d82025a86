// SPDX-License-Identifier: Apache-2.0
// A USB camera with a motorised focus (USB Video Class): a scene that is blurred by how far the
// lens is from its best focus at the time of the exposure.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "camera_controls.hpp"
#include "camera_descriptors.hpp"
#include "device.hpp"
#include "focus_motor.hpp"
#include "scene.hpp"

namespace fathom::usb {

struct CameraOptions {
  double best_focus = 600;
  double blur_px_per_unit = 1.0 / 64;  ///< Standard deviation of the blur per unit from best focus.
  double sharp_px = 0.6;               ///< Blur at best focus.
  std::string scene = "texture";
  std::uint32_t seed = 1;
  double noise = 0;  ///< Standard deviation, 8-bit grey levels.
  double frames_per_s = 30;
  int latency_frames = 0;  ///< A frame is this many frames older than one that comes at once.
  std::vector<FrameSize> sizes = {{256, 240}, {320, 240}, {640, 480}};
  ControlOptions controls;
  FocusMotorOptions motor;
};

/// Where a lens was at a time of CLOCK_MONOTONIC.
using LensPosition = std::function<double(std::int64_t time_ns)>;

class Camera : public Device {
 public:
  /// other_lens: a lens that something else moves; the camera's own focus then does nothing.
  explicit Camera(const CameraOptions& options, LensPosition other_lens = {});

  std::int64_t due_ns() const override;
  void run() override;

  void stall(bool stalled) { stalled_ = stalled; }  ///< No more data, as if the cable hung.
  void drop_frames(int count) { drop_ = count; }
  void corrupt_frames(int count) { corrupt_ = count; }  ///< Garbage, with the error bit.
  void shorten_frames(int count) { shorten_ = count; }  ///< Half a frame, without the error bit.
  /// The lens goes no further, and the camera does not say so until asked where it is.
  void clamp_focus(int least, int most) { clamp_ = {least, most}; }
  void jam_focus(bool jammed) { jammed_ = jammed; }  ///< The lens stays; the camera knows nothing.
  std::string status() const;

 protected:
  std::optional<Bytes> read_request(const Setup& setup) override;
  bool write_request(const Setup& setup, const Bytes& data) override;
  void endpoint_idle() override;

 private:
  struct Stream {
    int format = 0, size = 0;  ///< Indices, from 0.
    std::uint32_t interval_100ns = 0;
  };
  Bytes negotiated() const;
  void negotiate(const Bytes& wish);
  void moved(const Control& control);
  void drift(std::int64_t time_ns);
  std::int64_t frame_time_ns() const;
  double lens_at(std::int64_t time_ns) const;
  void begin_frame(std::int64_t due_ns);
  void expose(std::int64_t end_ns);
  void send_payload();

  CameraOptions options_;
  LensPosition other_lens_;
  CameraControls controls_;
  FocusMotor motor_;
  std::vector<std::unique_ptr<BlurredScene>> scenes_;  ///< One per size, made when wanted.
  std::mt19937 random_;
  Stream stream_;
  Bytes frame_;  ///< Being sent, from sent_ on.
  std::size_t sent_ = 0;
  bool sending_ = false, odd_ = false, bad_ = false;
  std::optional<std::int64_t> next_ns_;  ///< When the next frame is there; nothing while idle.
  bool stalled_ = false, jammed_ = false;
  int drop_ = 0, corrupt_ = 0, shorten_ = 0;
  std::optional<std::pair<int, int>> clamp_;
  std::uint64_t frames_ = 0;
  struct Shot {
    int size = -1, format = -1, blur = 0;
    Development development;
    bool operator==(const Shot&) const = default;
  } shot_;  ///< What frame_ shows, to show it again at no cost.
  Bytes picture_;
};

}  // namespace fathom::usb
