// SPDX-License-Identifier: Apache-2.0
// How an INDI camera is made ready: what it is told, and what it answers that it is.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/error.hpp"
#include "hal/clock.hpp"
#include "hal/drivers/indi/camera.hpp"

namespace fathom::indi {
namespace {

constexpr double kUsualExposure_ms = 500;
constexpr std::int64_t kQuiet_ns = 150'000'000;
constexpr std::int64_t kLoudest_ns = 2'000'000'000;
constexpr std::size_t kLargestPicture = std::size_t{1} << 30;
constexpr int kWidestChip_px = 100'000;

}  // namespace

IndiCamera::IndiCamera(std::unique_ptr<Client> client, std::string device,
                       const IndiSettings& settings, StopRequests stop_requests)
    : client_(std::move(client)),
      device_(std::move(device)),
      stop_requests_(std::move(stop_requests)),
      changes_(*client_, device_) {
  for (const char* name : {"CCD_EXPOSURE", "CCD_INFO", "CCD_FRAME", "CCD1"}) {
    client_->await(device_, name);
  }
  client_->wait_until_quiet(kQuiet_ns, kLoudest_ns);
  if (client_->need(device_, "CCD_EXPOSURE").state == State::busy) {
    throw Error(ErrorCode::unavailable,
                fmt::format("{} at {} is exposing for another program; wait until it is done, or "
                            "abort it there",
                            device_, client_->where()));
  }
  prepare(settings);
}

double IndiCamera::number(const std::string& property, const std::string& value) const {
  const Value* const found = client_->need(device_, property).find(value);
  return found == nullptr ? std::nan("") : found->number;
}

int IndiCamera::count(const std::string& property, const std::string& value, int fallback) const {
  if (client_->devices().find(device_, property) == nullptr) return fallback;
  const double found = number(property, value);
  if (found >= 1 && found <= kWidestChip_px) return static_cast<int>(found);
  throw Error(ErrorCode::bad_data, fmt::format("{} at {} says that its {} of {} is {}", device_,
                                               client_->where(), value, property, found));
}

void IndiCamera::prepare(const IndiSettings& settings) {
  constexpr std::pair<const char*, const char*> kSwitches[] = {
      {"UPLOAD_MODE", "UPLOAD_CLIENT"},     {"CCD_TRANSFER_FORMAT", "FORMAT_FITS"},
      {"CCD_COMPRESSION", "INDI_DISABLED"}, {"CCD_COMPRESSION", "CCD_RAW"},  // older drivers
      {"CCD_FRAME_TYPE", "FRAME_LIGHT"},    {"CCD_FAST_TOGGLE", "INDI_DISABLED"}};
  for (const auto& [property, value] : kSwitches) {
    const Property* const found = client_->devices().find(device_, property);
    if (found != nullptr && found->find(value) != nullptr) changes_.set_switch(property, value);
  }
  if (settings.polling_ms) {
    client_->await(device_, "POLLING_PERIOD");
    changes_.set_numbers("POLLING_PERIOD", {{"PERIOD_MS", *settings.polling_ms}});
  }
  const CameraWishes& wishes = settings.camera_wishes;
  if (wishes.gain) wish_gain(*wishes.gain);
  if (wishes.binning) {
    client_->await(device_, "CCD_BINNING");
    changes_.set_numbers("CCD_BINNING",
                         {{"HOR_BIN", *wishes.binning}, {"VER_BIN", *wishes.binning}});
    if (number("CCD_BINNING", "HOR_BIN") != *wishes.binning ||
        number("CCD_BINNING", "VER_BIN") != *wishes.binning) {
      throw Error(ErrorCode::unsupported,
                  fmt::format("{}: {} does not take binning={}; it set {} x {}", settings.where,
                              device_, *wishes.binning, number("CCD_BINNING", "HOR_BIN"),
                              number("CCD_BINNING", "VER_BIN")));
    }
  }
  read_limits();
  if (!knows_its_size()) learn_its_size(wishes.exposure_ms.value_or(kUsualExposure_ms));
  read_chip();
  wish_frame(wishes);
  longest_ms_ = std::max(shortest_ms_, std::min(longest_ms_, wishes.longest_exposure_ms));
  settings_.exposure_ms = wishes.exposure_ms.value_or(kUsualExposure_ms);
  CameraSettings nearest = settings_;
  if (validate(nearest) != Validity::valid && wishes.exposure_ms) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{}: {} takes no exposure_ms={}; the nearest is {}", settings.where,
                            device_, *wishes.exposure_ms, nearest.exposure_ms));
  }
  settings_ = nearest;
  const std::size_t pixels =
      static_cast<std::size_t>(chip_width_px_) * static_cast<std::size_t>(chip_height_px_);
  // Room for a colour picture of 16 bits and a long header, so that it is refused for what it is.
  client_->want_pictures(device_, std::min(6 * pixels + (1u << 20), kLargestPicture));
}

void IndiCamera::wish_gain(double gain) {
  for (const auto& [property, value] :
       {std::pair{"CCD_GAIN", "GAIN"}, std::pair{"CCD_CONTROLS", "Gain"}}) {
    const Property* const found = client_->devices().find(device_, property);
    if (found == nullptr || found->find(value) == nullptr) continue;
    changes_.set_numbers(property, {{value, gain}});
    const double taken = number(property, value);
    if (std::abs(taken - gain) <= 1e-6 * std::abs(gain)) return;
    throw Error(ErrorCode::unsupported,
                fmt::format("{} does not take gain={}; it set {}", device_, gain, taken));
  }
  throw Error(ErrorCode::unsupported,
              fmt::format("{} at {} has no gain to set; leave the key gain out", device_,
                          client_->where()));
}

bool IndiCamera::knows_its_size() const {
  constexpr std::pair<const char*, const char*> kSizes[] = {{"CCD_INFO", "CCD_MAX_X"},
                                                            {"CCD_INFO", "CCD_MAX_Y"},
                                                            {"CCD_FRAME", "WIDTH"},
                                                            {"CCD_FRAME", "HEIGHT"}};
  return std::none_of(std::begin(kSizes), std::end(kSizes),
                      [&](const auto& size) { return number(size.first, size.second) == 0; });
}

/// Takes a picture, whatever it is, and waits for what the driver learns from it.
void IndiCamera::learn_its_size(double exposure_ms) {
  client_->want_pictures(device_, kLargestPicture);
  settings_.exposure_ms =
      std::clamp(exposure_ms, shortest_ms_, std::max(shortest_ms_, longest_ms_));
  const StopWatch stop(stop_requests_);
  begin_exposure();
  const Waited waited = client_->wait([&] { return is_over(); }, overdue_ns(), &stop);
  if (waited != Waited::done) abort_exposure();
  if (waited == Waited::stopped) {
    throw Error(ErrorCode::cancelled, "stopped on request while the camera took its first picture");
  }
  is_exposing_ = false;
  client_->wait_unless_stopped([&] { return knows_its_size(); },
                               monotonic_now_ns() + std::min(client_->timeout_ns(), kLoudest_ns));
  client_->devices().take_picture();
  if (knows_its_size()) return;
  throw Error(ErrorCode::unsupported,
              fmt::format("{} at {} does not know how many pixels it has, and a first picture {}; "
                          "set the size in its driver (CCD_INFO)",
                          device_, client_->where(),
                          waited == Waited::done ? "did not tell" : "did not come"));
}

void IndiCamera::read_limits() {
  const Value* const exposure = client_->need(device_, "CCD_EXPOSURE").find("CCD_EXPOSURE_VALUE");
  if (exposure == nullptr) {
    throw Error(ErrorCode::bad_data, fmt::format("{} has a CCD_EXPOSURE without a value", device_));
  }
  const bool has_limits = exposure->highest > exposure->lowest && exposure->highest > 0;
  shortest_ms_ = has_limits ? std::max(exposure->lowest * 1000, 0.001) : 0.001;
  longest_ms_ = has_limits ? exposure->highest * 1000 : 3.6e6;
}

void IndiCamera::read_chip() {
  chip_width_px_ = count("CCD_INFO", "CCD_MAX_X", 0);
  chip_height_px_ = count("CCD_INFO", "CCD_MAX_Y", 0);
  bin_x_ = count("CCD_BINNING", "HOR_BIN", 1);
  bin_y_ = count("CCD_BINNING", "VER_BIN", 1);
  settings_.depth = number("CCD_INFO", "CCD_BITSPERPIXEL") <= 8 ? Depth::bits8 : Depth::bits16;
  read_frame();
}

void IndiCamera::read_frame() {
  settings_.width_px = count("CCD_FRAME", "WIDTH", 0) / bin_x_;
  settings_.height_px = count("CCD_FRAME", "HEIGHT", 0) / bin_y_;
}

void IndiCamera::set_frame(double x, double y, double width, double height) {
  changes_.set_numbers("CCD_FRAME", {{"X", x}, {"Y", y}, {"WIDTH", width}, {"HEIGHT", height}});
  read_frame();
}

/// A side that is not given is as it stands; a frame that is made smaller without a place is put in
/// the middle.
void IndiCamera::wish_frame(const CameraWishes& wishes) {
  const int width = wishes.width.value_or(count("CCD_FRAME", "WIDTH", 0));
  const int height = wishes.height.value_or(count("CCD_FRAME", "HEIGHT", 0));
  const double x = wishes.x       ? *wishes.x
                   : wishes.width ? std::max(0, (chip_width_px_ - width) / 2)
                                  : number("CCD_FRAME", "X");
  const double y = wishes.y        ? *wishes.y
                   : wishes.height ? std::max(0, (chip_height_px_ - height) / 2)
                                   : number("CCD_FRAME", "Y");
  const auto refuse = [&](const std::string& what) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{} takes no frame x={} y={} width={} height={}: {}", device_, x, y,
                            width, height, what));
  };
  if (x + width > chip_width_px_ || y + height > chip_height_px_) {
    refuse(fmt::format("its chip has {} x {} px", chip_width_px_, chip_height_px_));
  }
  set_frame(x, y, width, height);
  const bool is_kept = number("CCD_FRAME", "X") == x && number("CCD_FRAME", "Y") == y &&
                       number("CCD_FRAME", "WIDTH") == width &&
                       number("CCD_FRAME", "HEIGHT") == height;
  if (is_kept) return;
  refuse(fmt::format("the nearest is x={} y={} width={} height={}", number("CCD_FRAME", "X"),
                     number("CCD_FRAME", "Y"), number("CCD_FRAME", "WIDTH"),
                     number("CCD_FRAME", "HEIGHT")));
}

}  // namespace fathom::indi
