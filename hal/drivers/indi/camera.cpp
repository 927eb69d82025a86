// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/indi/camera.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/error.hpp"
#include "hal/camera_settings.hpp"
#include "hal/clock.hpp"
#include "hal/drivers/indi/fits.hpp"

namespace fathom::indi {
namespace {

constexpr double kMillisecond_ns = 1e6;
constexpr std::int64_t kAbort_ns = 2'000'000'000;
constexpr std::int64_t kEnding_ns = 100'000'000;  // from a picture to the end of its exposure
constexpr std::int64_t kLongestWait_ms = 1'000'000'000;
constexpr int kMostDamaged = 3;  // in a row: the next one will be no better

/// Refuses what is no FITS and what was cut off on the way.
void require_whole(const Blob& blob) {
  if (blob.format.ends_with(".z") || blob.format.ends_with(".fz")) {
    throw Error(ErrorCode::unsupported,
                fmt::format("the INDI camera sends compressed pictures ({}) though it was told not "
                            "to; switch its compression off",
                            blob.format));
  }
  if (blob.format != ".fits" && blob.format != ".fit") {
    throw Error(ErrorCode::unsupported,
                fmt::format("the INDI camera sends pictures of format \"{}\"; choose FITS "
                            "(CCD_TRANSFER_FORMAT)",
                            blob.format));
  }
  if (blob.is_damaged || blob.bytes.size() != blob.size) {
    throw Error(ErrorCode::bad_data,
                fmt::format("a picture of the INDI camera is truncated: {} of {} bytes",
                            blob.bytes.size(), blob.size));
  }
}

}  // namespace

IndiCamera::~IndiCamera() {
  try {
    if (is_exposing_) abort_exposure();
  } catch (...) {  // the server is gone; nobody is left who could be told
  }
}

std::string IndiCamera::description() const {
  const Property* const mosaic = client_->devices().find(device_, "CCD_CFA");
  const Value* const type = mosaic == nullptr ? nullptr : mosaic->find("CFA_TYPE");
  return fmt::format("INDI camera {} at {}, {} x {} px{}", device_, client_->where(),
                     chip_width_px_, chip_height_px_,
                     type == nullptr ? "" : fmt::format(", mosaic of colours {}", type->text));
}

Validity IndiCamera::validate(CameraSettings& wished) const {
  if (wished.width_px <= 0 || wished.height_px <= 0 || !(wished.exposure_ms > 0)) {
    return Validity::refused;
  }
  CameraSettings nearest = wished;
  nearest.depth = settings_.depth;
  nearest.width_px = std::min(wished.width_px, chip_width_px_ / bin_x_);
  nearest.height_px = std::min(wished.height_px, chip_height_px_ / bin_y_);
  nearest.exposure_ms = std::clamp(wished.exposure_ms, shortest_ms_, longest_ms_);
  return adjust(wished, nearest);
}

void IndiCamera::apply(const CameraSettings& settings) {
  CameraSettings wished = settings;
  if (validate(wished) != Validity::valid) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{} takes up to {} x {} px of {} bit and {} to {} ms; ask for those",
                            description(), chip_width_px_ / bin_x_, chip_height_px_ / bin_y_,
                            static_cast<int>(settings_.depth), shortest_ms_, longest_ms_));
  }
  if (wished == settings_) return;
  if (is_exposing_) abort_exposure();
  if (wished.width_px != settings_.width_px || wished.height_px != settings_.height_px) {
    const StopWatch stop(stop_requests_);
    while (!await_idle(monotonic_now_ns() + client_->timeout_ns(), stop)) {
    }
    apply_size(wished.width_px, wished.height_px);
  }
  settings_.exposure_ms = wished.exposure_ms;
}

/// A frame that would reach over an edge of the chip is moved away from it.
void IndiCamera::apply_size(int width_px, int height_px) {
  const double old[] = {number("CCD_FRAME", "X"), number("CCD_FRAME", "Y"),
                        number("CCD_FRAME", "WIDTH"), number("CCD_FRAME", "HEIGHT")};
  const int width = width_px * bin_x_, height = height_px * bin_y_;
  set_frame(std::min(old[0], static_cast<double>(chip_width_px_ - width)),
            std::min(old[1], static_cast<double>(chip_height_px_ - height)), width, height);
  const CameraSettings taken = settings_;
  if (taken.width_px == width_px && taken.height_px == height_px) return;
  set_frame(old[0], old[1], old[2], old[3]);
  throw Error(ErrorCode::unsupported,
              fmt::format("{} does not take {} x {} px; the nearest is {} x {}", device_, width_px,
                          height_px, taken.width_px, taken.height_px));
}

/// Whether no exposure runs, and what was asked of one that was given up has been answered.
bool IndiCamera::is_idle() {
  const Property& exposure = client_->need(device_, "CCD_EXPOSURE");
  return exposure.state != State::busy &&
         (runs_on_until_ns_ == 0 || exposure.serial != started_serial_);
}

/// Waits until no exposure runs whose picture could be taken for the next one's; false if one still
/// runs at the deadline.
bool IndiCamera::await_idle(std::int64_t deadline_ns, const StopWatch& stop) {
  client_->drain();
  if (!is_idle()) {
    if (busy_since_ns_ == 0) busy_since_ns_ = monotonic_now_ns();
    const std::int64_t patience_ns =
        std::max(busy_since_ns_ + client_->timeout_ns(), runs_on_until_ns_);
    const Waited waited =
        client_->wait([&] { return is_idle(); }, std::min(deadline_ns, patience_ns), &stop);
    if (waited == Waited::stopped) {
      throw Error(ErrorCode::cancelled, "stopped on request before an exposure began");
    }
    const std::int64_t busy_ns = monotonic_now_ns() - busy_since_ns_;
    if (waited == Waited::late && monotonic_now_ns() < patience_ns) return false;
    if (waited == Waited::late) {
      busy_since_ns_ = 0;
      throw Error(ErrorCode::unavailable,
                  fmt::format("{} at {}: another exposure has been running for {:.1f} s; wait "
                              "until it is done, or abort it where it was begun. timeout_s=SECONDS "
                              "waits longer",
                              device_, client_->where(), static_cast<double>(busy_ns) * 1e-9));
    }
    if (busy_ns > kEnding_ns) is_picture_due_ = true;
  }
  drop_picture();
  return true;
}

void IndiCamera::drop_picture() {
  // A driver may send it a moment after it has said that the exposure is over.
  if (is_picture_due_) {
    client_->wait([&] { return client_->devices().has_picture(); },
                  monotonic_now_ns() + kEnding_ns);
  }
  is_picture_due_ = false;
  busy_since_ns_ = runs_on_until_ns_ = 0;
  client_->devices().take_picture();
}

/// Only while the camera is idle.
void IndiCamera::begin_exposure() {
  const Property& exposure = client_->need(device_, "CCD_EXPOSURE");
  started_serial_ = exposure.serial;
  started_ns_ = monotonic_now_ns();
  client_->send_numbers(
      exposure, std::vector<NumberWish>{{"CCD_EXPOSURE_VALUE", settings_.exposure_ms / 1000}});
  is_exposing_ = true;
}

bool IndiCamera::is_over() {
  const Property& exposure = client_->need(device_, "CCD_EXPOSURE");
  if (client_->devices().has_picture()) return true;
  if (exposure.state != State::alert || exposure.serial == started_serial_) return false;
  is_exposing_ = false;
  throw Error(ErrorCode::device_lost,
              fmt::format("an exposure of {} failed{}", device_, client_->words_of(device_)));
}

/// When the picture of the running exposure should have come at the latest.
std::int64_t IndiCamera::overdue_ns() const {
  return started_ns_ + static_cast<std::int64_t>(settings_.exposure_ms * kMillisecond_ns) +
         client_->timeout_ns();
}

/// One that goes on all the same is waited out before the next one.
void IndiCamera::abort_exposure() {
  is_exposing_ = false;
  is_picture_due_ = true;
  runs_on_until_ns_ = overdue_ns();
  if (const Property* const abort = client_->devices().find(device_, "CCD_ABORT_EXPOSURE")) {
    client_->send_switch(*abort, "ABORT");
    client_->wait([&] { return is_idle(); },
                  monotonic_now_ns() + std::min(kAbort_ns, client_->timeout_ns()));
  }
}

std::optional<Frame> IndiCamera::take_picture() {
  const std::int64_t ended_ns = monotonic_now_ns();
  is_exposing_ = false;
  std::optional<Blob> blob = client_->devices().take_picture();
  try {
    require_whole(*blob);
    Frame frame =
        decode_fits(blob->bytes, {settings_.width_px, settings_.height_px, settings_.depth});
    frame.exposure = {started_ns_, ended_ns};
    ++counts_.delivered;
    damaged_in_a_row_ = 0;
    return frame;
  } catch (const Error& error) {
    ++counts_.corrupt;
    if (error.code() != ErrorCode::bad_data || ++damaged_in_a_row_ >= kMostDamaged) throw;
    return std::nullopt;
  }
}

std::optional<Frame> IndiCamera::grab(std::chrono::milliseconds timeout) {
  if (!lost_.empty()) throw Error(ErrorCode::device_lost, lost_);
  try {
    return expose(timeout);
  } catch (const Error& error) {
    const bool is_lost =
        error.code() == ErrorCode::device_lost || error.code() == ErrorCode::bad_data;
    if (is_lost) lost_ = fmt::format("{} was lost: {}; open it again", device_, error.what());
    throw;
  }
}

std::optional<Frame> IndiCamera::expose(std::chrono::milliseconds timeout) {
  const StopWatch stop(stop_requests_);
  const auto patience_ms = std::clamp<std::int64_t>(timeout.count(), 0, kLongestWait_ms);
  const std::int64_t deadline_ns = monotonic_now_ns() + patience_ms * 1'000'000;
  do {
    if (!is_exposing_) {
      if (!await_idle(deadline_ns, stop)) return std::nullopt;
      begin_exposure();
    }
    const std::int64_t latest_ns = std::min(deadline_ns, overdue_ns());
    switch (client_->wait([&] { return is_over(); }, latest_ns, &stop)) {
      case Waited::done:
        if (std::optional<Frame> frame = take_picture()) return frame;
        break;
      case Waited::stopped:
        abort_exposure();
        throw Error(ErrorCode::cancelled, "an exposure was stopped on request");
      case Waited::late:
        if (monotonic_now_ns() < overdue_ns()) return std::nullopt;
        abort_exposure();
        throw Error(
            ErrorCode::device_lost,
            fmt::format("{}: no picture {} s after the end of its exposure{}; does it hang? "
                        "timeout_s=SECONDS waits longer",
                        description(), static_cast<double>(client_->timeout_ns()) * 1e-9,
                        client_->words_of(device_)));
    }
  } while (monotonic_now_ns() < deadline_ns);
  return std::nullopt;
}

}  // namespace fathom::indi
