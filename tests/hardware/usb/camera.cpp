// SPDX-License-Identifier: Apache-2.0
#include "camera.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fathom::usb {

namespace {

// What uvcvideo asks for at once (32 packets): one transfer is one payload with its header.
constexpr std::size_t payload_bytes = 16384;
constexpr std::size_t header_bytes = 2;
constexpr int probe_bytes = 34;

Identity identity(const CameraOptions& options) {
  return {
      .vendor = 0x1d6b,
      .product = 0x0102,
      .device_class = 0xef,
      .subclass = 2,
      .protocol = 1,
      .maker = "Fathom",
      .name = "Simulated focus camera",
      .serial = "camera-" + std::to_string(options.seed),
      .configuration = camera_configuration(pixel_formats(), options.sizes, options.frames_per_s)};
}

// -1 to 1, forth and back.
double swing(std::int64_t time_ns, double period_s) {
  return std::sin(2 * std::numbers::pi * std::fmod(static_cast<double>(time_ns) * 1e-9, period_s) /
                  period_s);
}

}  // namespace

Camera::Camera(const CameraOptions& options, LensPosition other_lens)
    : Device(identity(options)),
      options_(options),
      other_lens_(std::move(other_lens)),
      controls_(options.controls),
      motor_(options.motor),
      scenes_(options.sizes.size()),
      random_(options.seed) {
  stream_.interval_100ns = frame_intervals_100ns(options_.frames_per_s).front();
}

std::optional<Bytes> Camera::read_request(const Setup& setup) {
  if ((setup.index & 0xff) != streaming_interface) {
    drift(now_ns());
    return controls_.read(setup);
  }
  if (setup.value >> 8 != 1 && setup.value >> 8 != 2) return std::nullopt;  // Probe, commit.
  if (setup.request == 0x86) return Bytes{3};                               // GET_INFO
  if (setup.request == 0x85) return Bytes{probe_bytes, 0};                  // GET_LEN
  return negotiated();
}

bool Camera::write_request(const Setup& setup, const Bytes& data) {
  if ((setup.index & 0xff) == streaming_interface) {
    negotiate(data);
    return true;
  }
  const Control* control = controls_.write(setup, data);
  if (control) moved(*control);
  return control != nullptr;
}

Bytes Camera::negotiated() const {
  Bytes bytes{0, 0, static_cast<std::uint8_t>(stream_.format + 1),
              static_cast<std::uint8_t>(stream_.size + 1)};
  append_number(bytes, stream_.interval_100ns, 4);
  append_number(bytes, 0, 10);
  append_number(bytes,
                frame_bytes(pixel_formats()[static_cast<std::size_t>(stream_.format)],
                            options_.sizes[static_cast<std::size_t>(stream_.size)]),
                4);
  append_number(bytes, payload_bytes, 4);
  append_number(bytes, 48'000'000, 4);
  append(bytes, {3, 0, 0, 0});
  return bytes;
}

void Camera::negotiate(const Bytes& wish) {
  if (wish.size() < 8) return;
  const auto within = [](int index, std::size_t count) {
    return std::clamp(index - 1, 0, static_cast<int>(count) - 1);
  };
  stream_.format = within(wish[2], pixel_formats().size());
  stream_.size = within(wish[3], options_.sizes.size());
  const auto intervals = frame_intervals_100ns(options_.frames_per_s);
  const std::uint32_t wished = number(std::span(wish).subspan(4), 4);
  const auto longer = std::lower_bound(intervals.begin(), intervals.end(), wished);
  stream_.interval_100ns = longer == intervals.end() ? intervals.back() : *longer;
}

void Camera::moved(const Control& control) {
  if (&control != &controls_.focus) return;
  if (clamp_) controls_.focus.value = std::clamp(control.value, clamp_->first, clamp_->second);
  if (!jammed_) motor_.command(controls_.focus.value, now_ns());
}

// What is automatic changes by itself, all the time: whoever leaves it on measures that.
void Camera::drift(std::int64_t time_ns) {
  const auto follow = [](Control& control, double wish) {
    const double steps = std::round((wish - control.least) / control.step);
    control.value = std::clamp(control.least + static_cast<int>(steps) * control.step,
                               control.least, control.most);
  };
  if (controls_.focus_auto.value != 0 && !jammed_) {
    const double reach = 0.15 * (controls_.focus.most - controls_.focus.least);
    follow(controls_.focus, options_.best_focus + reach * swing(time_ns, 1.3));
    motor_.command(controls_.focus.value, time_ns);
  }
  if (controls_.automatic_exposure()) {
    follow(controls_.exposure_100us,
           controls_.exposure_100us.initial * (1 + 0.4 * swing(time_ns, 1.1)));
  }
  if (controls_.white_balance_auto.value != 0) {
    follow(controls_.white_balance_k,
           controls_.white_balance_k.initial + 500 * swing(time_ns, 1.7));
  }
}

void Camera::endpoint_idle() {
  sending_ = false;
  next_ns_.reset();
}

std::int64_t Camera::frame_time_ns() const {
  const std::int64_t exposure_ns = controls_.exposure_100us.value * std::int64_t{100'000};
  return std::max(stream_.interval_100ns * std::int64_t{100}, exposure_ns);
}

std::int64_t Camera::due_ns() const {
  if (stalled_ || !wanted(streaming_endpoint)) return INT64_MAX;
  return sending_ ? 0 : next_ns_.value_or(0);
}

void Camera::run() {
  if (stalled_ || !wanted(streaming_endpoint)) return;
  const std::int64_t now = now_ns();
  if (!next_ns_) next_ns_ = now + frame_time_ns();
  // After a stall, the frames of that time are gone, not kept.
  if (!sending_ && now >= *next_ns_) begin_frame(std::max(*next_ns_, now - frame_time_ns()));
  if (sending_) send_payload();
}

void Camera::begin_frame(std::int64_t due_ns) {
  drift(due_ns);
  // A host that was too slow for a frame gets the next, not the missed ones one upon another.
  next_ns_ = std::max(due_ns + frame_time_ns(), now_ns());
  if (drop_ > 0) {
    --drop_;
    return;
  }
  // Of now, and not of when it was due: on a busy machine a frame that comes late would be older
  // than the latency that was asked for.
  expose(now_ns() - options_.latency_frames * frame_time_ns());
  frame_ = picture_;
  bad_ = corrupt_ > 0;
  if (bad_) {
    --corrupt_;
    for (std::size_t i = 0; i < frame_.size(); i += 3)
      frame_[i] = static_cast<std::uint8_t>(random_());
  }
  if (shorten_ > 0) {
    --shorten_;
    frame_.resize(frame_.size() / 2);
  }
  sending_ = true;
  sent_ = 0;
  odd_ = !odd_;
  ++frames_;
}

double Camera::lens_at(std::int64_t time_ns) const {
  return other_lens_ ? other_lens_(time_ns) : motor_.position_at(time_ns);
}

// Makes picture_, of what came in until end_ns.
void Camera::expose(std::int64_t end_ns) {
  const int exposure_100us = controls_.exposure_100us.value;
  // A lens that moves meanwhile is as good as where it was worst.
  double off = 0;
  for (const int part : {0, 1, 2}) {
    const std::int64_t time_ns = end_ns - exposure_100us * std::int64_t{50'000} * part;
    off = std::max(off, std::abs(lens_at(time_ns) - options_.best_focus));
  }
  const auto defocus = static_cast<int>(std::lround(off * options_.blur_px_per_unit * 64));
  Shot shot{stream_.size, stream_.format, defocus, {}};
  shot.development.gain = 1.0 * exposure_100us / controls_.exposure_100us.initial *
                          controls_.gain.value / controls_.gain.initial;
  shot.development.offset = controls_.brightness.value * 256;
  shot.development.blueness =
      (controls_.white_balance_k.initial - controls_.white_balance_k.value) / 40;
  shot.development.noise = options_.noise;
  if (options_.noise > 0) shot.development.noise_seed = static_cast<std::uint32_t>(random_());
  if (shot == shot_) return;
  auto& scene = scenes_[static_cast<std::size_t>(stream_.size)];
  if (!scene) {
    const FrameSize size = options_.sizes[static_cast<std::size_t>(stream_.size)];
    scene = std::make_unique<BlurredScene>(
        make_scene(options_.scene, options_.seed, size.width_px, size.height_px),
        options_.sharp_px);
  }
  picture_ = encode(pixel_formats()[static_cast<std::size_t>(stream_.format)], scene->at(defocus),
                    shot.development);
  shot_ = shot;
}

void Camera::send_payload() {
  const std::size_t room = std::min<std::size_t>(wanted_length(streaming_endpoint), payload_bytes);
  const std::size_t part = std::min(room - header_bytes, frame_.size() - sent_);
  const bool last = sent_ + part == frame_.size();
  constexpr int end_of_header = 0x80, error = 0x40, end_of_frame = 0x02;
  Bytes payload;
  payload.reserve(part + header_bytes);
  append(payload,
         {header_bytes, end_of_header | odd_ | (last ? end_of_frame : 0) | (bad_ ? error : 0)});
  const auto from = frame_.begin() + static_cast<std::ptrdiff_t>(sent_);
  payload.insert(payload.end(), from, from + static_cast<std::ptrdiff_t>(part));
  give(streaming_endpoint, payload);
  sent_ += part;
  sending_ = !last;
}

std::string Camera::status() const {
  return "plugged=" + std::to_string(plugged()) + " frames=" + std::to_string(frames_) +
         " lens=" + std::to_string(lens_at(now_ns())) +
         " focus=" + std::to_string(controls_.focus.value) +
         " focus_auto=" + std::to_string(controls_.focus_auto.value) +
         " exposure_auto=" + std::to_string(controls_.automatic_exposure()) +
         " exposure_ms=" + std::to_string(controls_.exposure_100us.value / 10.0) +
         " gain=" + std::to_string(controls_.gain.value) +
         " white_balance_auto=" + std::to_string(controls_.white_balance_auto.value);
}

}  // namespace fathom::usb
