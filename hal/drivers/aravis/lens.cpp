// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/aravis/lens.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/error.hpp"
#include "hal/approach.hpp"
#include "hal/clock.hpp"

namespace fathom::aravis {
namespace {

constexpr std::int64_t kSlice_ns = 10'000'000;
/// A feature that tells where the lens is may change until then, and be silent so long.
constexpr std::int64_t kLongestWay_ns = 30'000'000'000;
constexpr std::int64_t kSilence_ns = 500'000'000;
/// Of a feature without a step: as fine as the travel of a good voice coil.
constexpr double kUsualSteps = 1000;

/// What cameras call it: the standard's names, and those of makers.
constexpr const char* kUsualNames[] = {"FocalPower",
                                       "OpticControllerFocalPower",
                                       "FocusPos",
                                       "FocusPosition",
                                       "FocusStepper",
                                       "LensFocus",
                                       "LensFocusStep",
                                       "LiquidLensFocalPower",
                                       "LiquidLensPowerTarget"};

/// A number that can be read and set.
class Feature {
 public:
  Feature(std::shared_ptr<Device> device, std::string name)
      : device_(std::move(device)), name_(std::move(name)) {
    auto* const node =
        api().arv_device_get_feature(api().arv_camera_get_device(device_->camera()), name_.c_str());
    if (node == nullptr || !device_->has(name_)) fail("has no feature \"{}\"{}");
    auto* const instance = reinterpret_cast<GTypeInstance*>(node);
    is_whole_ = api().g_type_check_instance_is_a(instance, api().arv_gc_integer_get_type()) != 0;
    // A choice of words counts as an integer too.
    const bool is_choice =
        api().g_type_check_instance_is_a(instance, api().arv_gc_enumeration_get_type()) != 0;
    const bool is_float =
        api().g_type_check_instance_is_a(instance, api().arv_gc_float_get_type()) != 0;
    const bool is_number = !is_choice && (is_whole_ || is_float);
    if (!is_number) fail("has \"{}\", but that is no number{}");
    const char* const unit =
        is_whole_ ? api().arv_gc_integer_get_unit(reinterpret_cast<ArvGcInteger*>(node))
                  : api().arv_gc_float_get_unit(reinterpret_cast<ArvGcFloat*>(node));
    unit_ = unit == nullptr || *unit == 0 ? "units" : unit;
  }

  const std::string& unit() const { return unit_; }
  Range range() const {
    return is_whole_ ? device_->integer_range(name_) : device_->number_range(name_);
  }
  double read() const {
    return is_whole_ ? static_cast<double>(device_->integer(name_)) : device_->number(name_);
  }
  void write(double value) const {
    is_whole_ ? device_->set_integer(name_, std::llround(value))
              : device_->set_number(name_, value);
  }

 private:
  [[noreturn]] void fail(fmt::format_string<std::string&, std::string> what) {
    const std::string others = focus_features(*device_);
    throw Error(
        ErrorCode::unsupported,
        fmt::format("{} {}", device_->name(),
                    fmt::format(what, name_, others.empty() ? "" : "; it has lens=" + others)));
  }

  std::shared_ptr<Device> device_;
  std::string name_;
  std::string unit_;
  bool is_whole_ = false;
};

class FeatureLens final : public Lens {
 public:
  FeatureLens(const std::shared_ptr<Device>& device, const LensKeys& keys,
              const StopRequests& stop_requests)
      : device_(device), keys_(keys), feature_(device, keys.node), stop_requests_(stop_requests) {
    restorer_ = std::make_unique<FeatureRestorer>(device);
    restorer_->set_text("FocusAuto", "Off");
    const Range range = feature_.range();
    info_.description = fmt::format("aravis {} of {}", keys.node, device->name());
    info_.unit = feature_.unit();
    info_.lowest = std::max(range.lowest, keys.lowest.value_or(range.lowest));
    info_.highest = std::min(range.highest, keys.highest.value_or(range.highest));
    const double travel = info_.highest - info_.lowest;
    if (!(travel > 0) || !std::isfinite(travel) ||
        keys.lowest.value_or(info_.lowest) < range.lowest ||
        keys.highest.value_or(info_.highest) > range.highest) {
      throw Error(ErrorCode::unsupported,
                  fmt::format("{}: {} goes from {:g} to {:g}, which leaves no travel between "
                              "lowest and highest",
                              device->name(), keys.node, range.lowest, range.highest));
    }
    const double finest = range.step > 0 ? range.step : travel / kUsualSteps;
    info_.resolution = std::min(std::max(keys.step.value_or(finest), range.step), travel);
    keys.traits.describe(info_);
  }

  LensInfo info() const override { return info_; }
  double position() const override { return feature_.read(); }

  std::string why_unwatched() const override {
    return "the camera says where its lens was sent, not where it is on the way";
  }

  Arrival move_to(double position) override {
    require_within(info_, position);
    const StopWatch watch(stop_requests_);
    const double target = nearest(position);
    Arrival arrival;
    arrival.started_ns = monotonic_now_ns();
    const double from = feature_.read();
    // Nobody knows from which side it came to where it was found.
    const bool comes_from_below = from < target && is_known_;
    if (!comes_from_below && from != target && keys_.traits.backlash > 0 && target > info_.lowest) {
      drive(nearest(std::max(info_.lowest, target - keys_.traits.backlash)), watch);
      rest(monotonic_now_ns() + keys_.traits.settle_ns(), watch);
    }
    arrival.position = drive(target, watch);
    is_known_ = true;
    arrival.stopped_ns = monotonic_now_ns();
    rest(arrival.stopped_ns + keys_.traits.settle_ns(), watch);
    arrival.settled_ns = monotonic_now_ns();
    return arrival;
  }

  Arrival home() override { return move_to(info_.lowest); }

 private:
  /// Most cameras say at once that it is there; some tell where it is on its way.
  double drive(double target, const StopWatch& watch) {
    feature_.write(target);
    const std::int64_t started_ns = monotonic_now_ns();
    std::int64_t heard_ns = started_ns;
    double reported = feature_.read();
    while (std::abs(reported - target) > info_.resolution * 1e-3) {
      const std::int64_t now_ns = monotonic_now_ns();
      if (now_ns - heard_ns > kSilence_ns || now_ns - started_ns > kLongestWay_ns) {
        return arrived_beside(target, reported);
      }
      rest(now_ns + kSlice_ns, watch);
      const double again = feature_.read();
      if (again != reported) heard_ns = monotonic_now_ns();
      reported = again;
    }
    return target;
  }

  /// A value that the camera rounds to its own grid is the same place.
  double arrived_beside(double target, double reported) const {
    if (std::abs(reported - target) <= accuracy_of(info_)) return reported;
    throw Error(ErrorCode::device_lost,
                fmt::format("{}: {} was sent to {:g} and stands at {:g}; is it blocked?",
                            device_->name(), keys_.node, target, reported));
  }

  void rest(std::int64_t until_ns, const StopWatch& watch) const {
    for (std::int64_t now_ns = monotonic_now_ns(); now_ns < until_ns; now_ns = monotonic_now_ns()) {
      if (device_->is_lost()) device_->fail_lost();
      if (watch.stopped()) {
        throw Error(ErrorCode::cancelled, fmt::format("stopped on request, with {} at {:g}",
                                                      keys_.node, feature_.read()));
      }
      sleep_until_ns(std::min(until_ns, now_ns + kSlice_ns));
    }
  }

  std::shared_ptr<Device> device_;
  LensKeys keys_;
  Feature feature_;
  StopRequests stop_requests_;
  std::unique_ptr<FeatureRestorer> restorer_;
  LensInfo info_;
  bool is_known_ = false;  ///< Whether a move of ours ended where it stands.
};

}  // namespace

std::unique_ptr<Lens> open_lens(const std::shared_ptr<Device>& device, const LensKeys& keys,
                                const StopRequests& stop_requests) {
  return std::make_unique<FeatureLens>(device, keys, stop_requests);
}

std::string focus_features(const Device& device) {
  std::vector<std::string> names;
  for (const char* const name : kUsualNames) {
    if (device.has(name)) names.emplace_back(name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace fathom::aravis
