// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/serial/device.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <cstdlib>

#include "engine/error.hpp"
#include "hal/clock.hpp"

namespace fathom::serial {
namespace {

constexpr std::int64_t kGlance_ns = 20'000'000;  // how long a look may wait for an arrival
constexpr int kMostAsked = 5;
constexpr double kFarthest = 1e12;

}  // namespace

Device::Device(const Settings& settings)
    : profile_(settings.profile),
      port_(settings.port, profile_.baud, profile_.answer_end),
      dialogue_(port_, profile_) {
  dialogue_.begin();
}

/// A number as the device counts.
double Device::number(const std::string& text) const {
  const char* const begin = text.c_str();
  char* end = nullptr;
  const double value = profile_.number_base == 10
                           ? std::strtod(begin, &end)
                           : static_cast<double>(std::strtoll(begin, &end, profile_.number_base));
  if (end != begin && *end == '\0' && std::abs(value) <= kFarthest) return value;
  throw Error(ErrorCode::bad_data,
              fmt::format("{} says that it stands at \"{}\", which is no number", name(), text));
}

double Device::unit_from(const Answer& answer, const Command& command) const {
  const auto text = command.answer->find(answer.line);
  if (!text) {
    throw Error(ErrorCode::bad_data,
                fmt::format("{} does not say where it is: \"{}\"", name(), answer.line));
  }
  return (number(*text) - zero_) / profile_.scale;
}

std::string Device::why_unknown() {
  if (is_lost()) return dialogue_.lost();
  if (profile_.known) {
    const Answer answer = dialogue_.ask(*profile_.known);
    if (!profile_.known->good->is_in(answer.line)) {
      return fmt::format("{} says \"{}\": it has not found its reference", name(), answer.line);
    }
  }
  if (profile_.state && profile_.unknown) {
    const Answer answer = dialogue_.ask(*profile_.state);
    if (profile_.unknown->is_in(answer.line)) {
      return fmt::format("{} says \"{}\"", name(), answer.line);
    }
  }
  return {};
}

double Device::position() {
  std::optional<double> before;
  for (int i = 0; i < kMostAsked; ++i) {
    const double now = unit_from(dialogue_.ask(profile_.position), profile_.position);
    if (before && std::abs(now - *before) <= profile_.step / 2) return now;
    before = now;
  }
  throw Error(ErrorCode::bad_data,
              fmt::format("{} says another place each time it is asked; is something else moving "
                          "it, or is the line noisy?",
                          name()));
}

void Device::send_to(double position) {
  const double counted = zero_ + position * profile_.scale;
  dialogue_.order(profile_.move, {counted, std::llround(counted)});
  awaited_ = nullptr;
}

Look Device::look() {
  if (awaited_ != nullptr) return await(*awaited_);
  if (profile_.state) {
    const Answer state = dialogue_.ask(*profile_.state);
    if (profile_.unknown && profile_.unknown->is_in(state.line)) {
      throw Error(ErrorCode::device_lost,
                  fmt::format("{} says \"{}\" on its way: it does not know where it is", name(),
                              state.line));
    }
    const bool tells_all = profile_.state->send == profile_.position.send;
    const Answer place = tells_all ? state : dialogue_.ask(profile_.position);
    return {profile_.moving->is_in(state.line), unit_from(place, profile_.position), place.asked_ns,
            place.heard_ns};
  }
  dialogue_.say(*profile_.arrive);
  return await(*profile_.arrive);
}

/// A glance at whether the answer to what was said has come.
Look Device::await(const Command& command) {
  awaited_ = &command;
  const std::int64_t now_ns = monotonic_now_ns();
  const auto answer = dialogue_.hear(command, now_ns + kGlance_ns);
  if (answer) {
    awaited_ = nullptr;
    require_good(command, *answer);
  }
  // One that can tell whether it moves is asked that too.
  return {!answer || profile_.state.has_value(), std::nullopt, now_ns, now_ns};
}

void Device::require_good(const Command& command, const Answer& answer) const {
  if (!command.good || command.good->is_in(answer.line)) return;
  throw Error(ErrorCode::unsupported,
              fmt::format("{} will not go: it says \"{}\"", name(), answer.line));
}

void Device::halt() {
  if (profile_.stop) dialogue_.interrupt(*profile_.stop);
  awaited_ = nullptr;
}

void Device::send_home() {
  dialogue_.found_again();  // homing is what helps
  awaited_ = nullptr;
  if (!profile_.home->at_end) {
    dialogue_.order(*profile_.home);
    return;
  }
  dialogue_.say(*profile_.home);
  awaited_ = &*profile_.home;
}

void Device::count_from(double position) {
  zero_ = 0;
  const double counted = this->position() * profile_.scale;
  zero_ = counted - position * profile_.scale;
}

}  // namespace fathom::serial
