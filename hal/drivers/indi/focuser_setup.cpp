// SPDX-License-Identifier: Apache-2.0
// How an INDI focuser is made ready: what it is told, and what it answers that it is.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "engine/error.hpp"
#include "hal/clock.hpp"
#include "hal/drivers/indi/focuser.hpp"

namespace fathom::indi {
namespace {

constexpr std::int64_t kQuiet_ns = 150'000'000;
constexpr std::int64_t kLoudest_ns = 2'000'000'000;

bool holds(std::string text, const char* word) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text.find(word) != std::string::npos;
}

/// The switch that a driver calls one of many names; null for a property that is none.
const Value* compensation_off(const Property& property) {
  if (property.kind != Kind::toggle || !holds(property.name, "COMP")) return nullptr;
  if (!holds(property.name, "TEMP") && !holds(property.name, "T. ")) return nullptr;
  const auto off = std::find_if(
      property.values.begin(), property.values.end(),
      [](const Value& value) { return holds(value.name, "DISABLE") || holds(value.name, "OFF"); });
  return off == property.values.end() ? nullptr : &*off;
}

}  // namespace

IndiFocuser::IndiFocuser(std::unique_ptr<Client> client, std::string device,
                         const IndiSettings& settings, StopRequests stop_requests)
    : client_(std::move(client)),
      device_(std::move(device)),
      stop_requests_(std::move(stop_requests)),
      wishes_(settings.focuser_wishes),
      changes_(*client_, device_) {
  const auto has_motion = [&] {
    return client_->devices().find(device_, kAbsolute) != nullptr ||
           client_->devices().find(device_, kRelative) != nullptr;
  };
  if (!client_->wait_unless_stopped(has_motion, monotonic_now_ns() + client_->timeout_ns())) {
    throw Error(ErrorCode::timeout,
                fmt::format("{} at {} has neither {} nor {} after {} s; is it a focuser?", device_,
                            client_->where(), kAbsolute, kRelative,
                            static_cast<double>(client_->timeout_ns()) * 1e-9));
  }
  client_->wait_until_quiet(kQuiet_ns, kLoudest_ns);
  prepare(settings);
  if (!is_absolute_ && wishes_.home) home();
}

void IndiFocuser::prepare(const IndiSettings& settings) {
  is_absolute_ = client_->devices().find(device_, kAbsolute) != nullptr;
  info_.description = fmt::format("INDI focuser {} at {}, {}", device_, client_->where(),
                                  is_absolute_ ? "absolute" : "relative");
  info_.unit = "steps";
  info_.resolution = 1;
  if (is_absolute_) {
    const Value* const value = client_->need(device_, kAbsolute).find(kAbsoluteValue);
    if (value != nullptr) info_.lowest = value->lowest, info_.highest = value->highest;
    refuse_relative_keys(settings.where);
  } else {
    client_->await(device_, "FOCUS_MOTION");
    info_.highest = travel();
    counted_ = wishes_.start;
    if (counted_) require_within(info_, *counted_);
  }
  if (const Property* const most = client_->devices().find(device_, "FOCUS_MAX")) {
    const Value* const value = most->find("FOCUS_MAX_VALUE");
    if (value != nullptr && value->number > 0) {
      info_.highest = std::min(info_.highest, value->number);
    }
  }
  if (!(info_.lowest >= -kMostSteps && info_.highest <= kMostSteps &&
        info_.highest - info_.lowest >= 1)) {
    throw Error(ErrorCode::bad_data, fmt::format("{} says that it travels from {} to {} steps",
                                                 info_.description, info_.lowest, info_.highest));
  }
  info_.lowest = std::ceil(info_.lowest);
  info_.highest = std::floor(info_.highest);
  wishes_.traits.describe(info_);
  if (settings.polling_ms) {
    client_->await(device_, "POLLING_PERIOD");
    changes_.set_numbers("POLLING_PERIOD", {{"PERIOD_MS", *settings.polling_ms}});
  }
  hold_still();
}

void IndiFocuser::refuse_relative_keys(const std::string& where) const {
  const char* const key = wishes_.start    ? "start"
                          : wishes_.home   ? "home"
                          : wishes_.travel ? "travel"
                                           : nullptr;
  if (key == nullptr) return;
  throw Error(ErrorCode::bad_argument,
              fmt::format("{}: {} means nothing to {}: an absolute focuser counts by itself; leave "
                          "the key out",
                          where, key, info_.description));
}

void IndiFocuser::hold_still() {
  std::vector<std::pair<std::string, std::string>> switches;
  for (const auto& [key, property] : client_->devices().all()) {
    const Value* const off = key.first == device_ ? compensation_off(property) : nullptr;
    if (off != nullptr) switches.emplace_back(property.name, off->name);
  }
  for (const auto& [property, value] : switches) changes_.set_switch(property, value);
}

double IndiFocuser::travel() const {
  if (wishes_.travel) return *wishes_.travel;
  const Property* const most = client_->devices().find(device_, "FOCUS_MAX");
  const Value* const value = most == nullptr ? nullptr : most->find("FOCUS_MAX_VALUE");
  if (value != nullptr && value->number > kMostSteps) {
    throw Error(ErrorCode::bad_data,
                fmt::format("{} says that it travels {} steps", info_.description, value->number));
  }
  if (value != nullptr && value->number >= 1) return value->number;
  throw Error(ErrorCode::unsupported,
              fmt::format("{} does not say how far it travels; add travel=STEPS, from its inner "
                          "stop to its outer one",
                          info_.description));
}

}  // namespace fathom::indi
