// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/alpaca/camera.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hal/camera_settings.hpp"
#include "hal/clock.hpp"

namespace fathom::alpaca {
namespace {

constexpr std::int64_t kMillisecond_ns = 1'000'000;
constexpr double kMsPerS = 1000;
constexpr std::int64_t kLongestWait_ms = 1'000'000'000;
/// A server is asked so often whether a picture is ready.
constexpr std::int64_t kPoll_ns = 20 * kMillisecond_ns;
constexpr int kMostDamaged = 3;
constexpr double kLongestAsked_ms = 3.6e6;
/// CameraStates.cameraError of ASCOM.
constexpr int kStateError = 5;
/// Of a pixel in JSON, colour and brackets with it; ImageBytes takes less.
constexpr std::size_t kMostBytesOfPixel = 64;

}  // namespace

AlpacaCamera::AlpacaCamera(std::unique_ptr<Connection> connection, std::string device,
                           const CameraKeys& keys, StopRequests stop_requests)
    : connection_(std::move(connection)),
      device_(std::move(device)),
      stop_requests_(std::move(stop_requests)) {
  connect();
  name_ = connection_->text(device_, "name");
  set_up(keys);
}

AlpacaCamera::~AlpacaCamera() {
  if (exposing_since_ns_ && !loss_) abort_exposure();
}

std::string AlpacaCamera::description() const {
  return fmt::format("alpaca {} ({} at {}), {} x {} px", name_, device_,
                     connection_->address().text(), settings_.width_px, settings_.height_px);
}

int AlpacaCamera::whole(const char* property) const {
  constexpr double kMost = 1e6;
  const double value = number(property);
  if (value >= 0 && value <= kMost) return static_cast<int>(std::lround(value));
  throw Error(ErrorCode::bad_data, fmt::format("{} of {} at {} is {}", property, device_,
                                               connection_->address().text(), value));
}

void AlpacaCamera::put(const char* property, double value) const {
  connection_->put(device_, property, fmt::format("{}={}", property, value));
}

void AlpacaCamera::put_and_restore(const char* property, double value) {
  const double found = number(property);
  if (found == value) return;
  restorer_.at_end([this, property, found] { put(property, found); });
  put(property, value);
}

void AlpacaCamera::connect() {
  if (connection_->flag(device_, "connected")) return;
  connection_->put(device_, "connected", "Connected=True");
  restorer_.at_end([this] { connection_->put(device_, "connected", "Connected=False"); });
}

void AlpacaCamera::set_up(const CameraKeys& keys) {
  const double brightest = number("maxadu");
  if (!(brightest >= 1 && brightest <= 65535)) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{} at {} has grey values up to {}; 65535 is the most that is read",
                            device_, connection_->address().text(), brightest));
  }
  settings_.depth = brightest <= 255 ? Depth::bits8 : Depth::bits16;
  const int binning = keys.binning.value_or(whole("BinX"));
  set_binning(binning);
  widest_px_ = whole("cameraxsize") / binning;
  highest_px_ = whole("cameraysize") / binning;
  set_region(keys);
  if (keys.gain) put_and_restore("Gain", *keys.gain);
  learn_exposures(keys);
}

void AlpacaCamera::set_binning(int binning) {
  const int most = whole("maxbinx");
  if (binning < 1 || binning > std::max(most, 1)) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{} at {} cannot keep binning={}; it goes to {}", device_,
                            connection_->address().text(), binning, most));
  }
  put_and_restore("BinX", binning);
  put_and_restore("BinY", binning);
}

void AlpacaCamera::set_region(const CameraKeys& keys) {
  set_side("StartX", "NumX", widest_px_, keys.x, keys.width);
  set_side("StartY", "NumY", highest_px_, keys.y, keys.height);
  settings_.width_px = whole("NumX");
  settings_.height_px = whole("NumY");
  if (settings_.width_px > 0 && settings_.height_px > 0) return;
  throw Error(ErrorCode::bad_data,
              fmt::format("{} at {} has pictures of {} x {} px", device_,
                          connection_->address().text(), settings_.width_px, settings_.height_px));
}

/// What binning has made too large becomes all that there is.
void AlpacaCamera::set_side(const char* start, const char* length, int most,
                            std::optional<int> from, std::optional<int> count) {
  const int old_from = whole(start), old_count = whole(length);
  const int new_from = from.value_or(old_from < most ? old_from : 0);
  const int new_count = count.value_or(std::clamp(old_count, 1, std::max(most - new_from, 1)));
  if (new_from + new_count > most) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{} at {}: {} px from {} on are not on its {} px", device_,
                            connection_->address().text(), new_count, new_from, most));
  }
  put_and_restore(start, new_from);
  put_and_restore(length, new_count);
}

void AlpacaCamera::learn_exposures(const CameraKeys& keys) {
  shortest_ms_ = number("exposuremin") * kMsPerS;
  longest_ms_ = std::min(number("exposuremax") * kMsPerS, kLongestAsked_ms);
  constexpr double kUsual_ms = 100;
  const double wished_ms =
      keys.exposure_ms.value_or(std::clamp(kUsual_ms, shortest_ms_, longest_ms_));
  if (!(wished_ms >= shortest_ms_ && wished_ms <= longest_ms_)) {
    throw Error(
        ErrorCode::unsupported,
        fmt::format("{} at {} cannot keep exposure_ms={:g}; it goes from {:g} to {:g}", device_,
                    connection_->address().text(), wished_ms, shortest_ms_, longest_ms_));
  }
  settings_.exposure_ms = wished_ms;
}

Validity AlpacaCamera::validate(CameraSettings& wished) const {
  if (!have_meaning(wished)) return Validity::refused;
  return adjust(wished,
                {std::min(wished.width_px, widest_px_), std::min(wished.height_px, highest_px_),
                 settings_.depth, std::clamp(wished.exposure_ms, shortest_ms_, longest_ms_)});
}

void AlpacaCamera::apply(const CameraSettings& settings) {
  require_valid(*this, settings);
  if (loss_) throw *loss_;
  if (settings == settings_) return;
  if (exposing_since_ns_) abort_exposure();
  CameraKeys keys;
  keys.width = settings.width_px;
  keys.height = settings.height_px;
  if (whole("StartX") + settings.width_px > widest_px_) keys.x = 0;
  if (whole("StartY") + settings.height_px > highest_px_) keys.y = 0;
  set_region(keys);
  settings_.exposure_ms = settings.exposure_ms;
}

std::chrono::milliseconds AlpacaCamera::patience() const {
  // A picture has a timeout of its own to come over the network.
  return std::chrono::milliseconds(2 * connection_->timeout_ns() / kMillisecond_ns);
}

std::optional<Frame> AlpacaCamera::grab(std::chrono::milliseconds timeout) {
  if (loss_) throw *loss_;
  try {
    return expose(timeout);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled) throw;
    // What a server refuses or answers wrong it will again.
    loss_ = Error(ErrorCode::device_lost,
                  fmt::format("{} was lost: {}; open it again", device_, error.what()));
    throw *loss_;
  }
}

std::optional<Frame> AlpacaCamera::expose(std::chrono::milliseconds timeout) {
  const StopWatch stop(stop_requests_);
  const std::int64_t wait_ms = std::clamp<std::int64_t>(timeout.count(), 0, kLongestWait_ms);
  const std::int64_t deadline_ns = monotonic_now_ns() + wait_ms * kMillisecond_ns;
  do {
    if (!exposing_since_ns_) begin_exposure();
    if (is_ready()) {
      if (std::optional<Frame> frame = take_picture()) return frame;
      continue;
    }
    if (stop.stopped()) {
      abort_exposure();
      throw Error(ErrorCode::cancelled, "an exposure was stopped on request");
    }
    require_in_time();
    sleep_until_ns(std::min(deadline_ns, monotonic_now_ns() + kPoll_ns));
  } while (monotonic_now_ns() < deadline_ns);
  return std::nullopt;
}

void AlpacaCamera::begin_exposure() {
  const std::int64_t now_ns = monotonic_now_ns();
  connection_->put(device_, "startexposure",
                   fmt::format("Duration={}&Light=True", settings_.exposure_ms / kMsPerS));
  exposing_since_ns_ = now_ns;
}

bool AlpacaCamera::is_ready() {
  if (connection_->flag(device_, "imageready")) return true;
  if (static_cast<int>(number("camerastate")) != kStateError) return false;
  throw Error(ErrorCode::device_lost, "its exposure failed");
}

void AlpacaCamera::require_in_time() {
  const auto exposure_ns = static_cast<std::int64_t>(settings_.exposure_ms * kMillisecond_ns);
  const std::int64_t late_ns = monotonic_now_ns() - *exposing_since_ns_ - exposure_ns;
  if (late_ns <= connection_->timeout_ns()) return;
  abort_exposure();
  throw Error(ErrorCode::device_lost,
              fmt::format("no picture {:g} s after the end of its exposure; timeout_s=SECONDS "
                          "waits longer",
                          static_cast<double>(late_ns) * 1e-9));
}

void AlpacaCamera::abort_exposure() noexcept {
  exposing_since_ns_.reset();
  try {
    if (connection_->flag(device_, "canabortexposure"))
      connection_->put(device_, "abortexposure", "");
  } catch (...) {  // the exposure ends by itself; its picture is of a time that was told
  }
}

std::optional<Frame> AlpacaCamera::take_picture() {
  const Exposure exposure{*exposing_since_ns_, monotonic_now_ns()};
  exposing_since_ns_.reset();
  const std::size_t pixels = static_cast<std::size_t>(settings_.width_px) * settings_.height_px;
  const auto picture = connection_->picture(device_, (pixels + 1024) * kMostBytesOfPixel);
  const ImageShape shape{settings_.width_px, settings_.height_px, settings_.depth};
  try {
    Frame frame = picture.is_bytes
                      ? frame_of_bytes({reinterpret_cast<const std::uint8_t*>(picture.body.data()),
                                        picture.body.size()},
                                       shape)
                      : frame_of_json(picture.body, shape);
    frame.exposure = exposure;
    ++counts_.delivered;
    damaged_in_a_row_ = 0;
    return frame;
  } catch (const Error& error) {
    ++counts_.corrupt;
    if (error.code() != ErrorCode::bad_data || ++damaged_in_a_row_ >= kMostDamaged) throw;
    return std::nullopt;
  }
}

}  // namespace fathom::alpaca
