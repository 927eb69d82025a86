// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/indi/client.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/error.hpp"
#include "hal/clock.hpp"

namespace fathom::indi {
namespace {

constexpr std::int64_t kMillisecond_ns = 1'000'000;
constexpr std::int64_t kSlice_ns = 50 * kMillisecond_ns;  // how soon a stop request is seen
constexpr std::int64_t kDrain_ns = 100 * kMillisecond_ns;
constexpr std::int64_t kSecondAnswer_ns = 500 * kMillisecond_ns;
constexpr std::size_t kPiece_bytes = 64 * 1024;

}  // namespace

Client::Client(const Address& address, std::int64_t timeout_ns, StopRequests stop_requests)
    : where_(address.text()),
      timeout_ns_(timeout_ns),
      stop_requests_(std::move(stop_requests)),
      socket_(
          {.address = address,
           .kind = "INDI server",
           .advice = "start one (indiserver DRIVER ...), or name another with server=HOST:PORT"},
          monotonic_now_ns() + timeout_ns, stop_requests_) {
  send("<getProperties version=\"1.7\"/>\n");
}

void Client::send(const std::string& text) {
  if (!broken_.empty()) throw Error(ErrorCode::device_lost, broken_);
  try {
    socket_.send(text, monotonic_now_ns() + timeout_ns_);
  } catch (const Error& error) {  // half of a request may be on its way
    broken_ = error.what();
    throw;
  }
}

bool Client::read(std::int64_t deadline_ns) {
  if (!broken_.empty()) throw Error(ErrorCode::device_lost, broken_);
  std::array<char, kPiece_bytes> room;
  const std::size_t count = socket_.receive(room, deadline_ns);
  try {
    for (Element& element : stream_.feed({room.data(), count})) devices_.take(std::move(element));
  } catch (const Error& error) {
    broken_ = fmt::format("the connection to {} cannot be used any more: {}; open the rig again",
                          where_, error.what());
    throw;
  }
  return count > 0;
}

void Client::drain() {
  const std::int64_t deadline_ns = monotonic_now_ns() + kDrain_ns;
  while (read(0) && monotonic_now_ns() < deadline_ns) {
  }
}

Waited Client::wait(const std::function<bool()>& done, std::int64_t deadline_ns,
                    const StopWatch* stop) {
  for (;;) {
    if (stop != nullptr && stop->stopped()) return Waited::stopped;
    if (done()) return Waited::done;
    const std::int64_t now_ns = monotonic_now_ns();
    const bool is_late = now_ns >= deadline_ns;  // what has come already still counts
    const bool has_read = read(is_late ? 0 : std::min(deadline_ns, now_ns + kSlice_ns));
    if (is_late) return has_read && done() ? Waited::done : Waited::late;
  }
}

bool Client::wait_unless_stopped(const std::function<bool()>& done, std::int64_t deadline_ns) {
  const StopWatch stop(stop_requests_);
  const Waited waited = wait(done, deadline_ns, &stop);
  if (waited != Waited::stopped) return waited == Waited::done;
  throw Error(ErrorCode::cancelled, fmt::format("stopped on request while {} was asked", where_));
}

void Client::wait_until_quiet(std::int64_t quiet_ns, std::int64_t at_most_ns) {
  const std::int64_t deadline_ns = monotonic_now_ns() + at_most_ns;
  while (monotonic_now_ns() < deadline_ns) {
    const std::uint64_t before = devices_.definitions();
    const std::int64_t until_ns = std::min(deadline_ns, monotonic_now_ns() + quiet_ns);
    if (!wait_unless_stopped([&] { return devices_.definitions() != before; }, until_ns)) return;
  }
}

const Property& Client::need(const std::string& device, const std::string& name) {
  if (const Property* property = devices_.find(device, name)) return *property;
  throw Error(ErrorCode::device_lost,
              fmt::format("{} at {} has no {} any more{}; has its driver crashed, or somebody "
                          "disconnected it? Open it again",
                          device, where_, name, words_of(device)));
}

const Property& Client::await(const std::string& device, const std::string& name) {
  const auto is_there = [&] { return devices_.find(device, name) != nullptr; };
  if (wait_unless_stopped(is_there, monotonic_now_ns() + timeout_ns_)) return need(device, name);
  throw Error(
      ErrorCode::timeout,
      fmt::format("{} at {} has no property {} after {} s{}; is it the right device, and "
                  "connected?",
                  device, where_, name, static_cast<double>(timeout_ns_) * 1e-9, words_of(device)));
}

void Client::want_pictures(const std::string& device, std::size_t limit_bytes) {
  stream_.set_blob_limit(limit_bytes);
  send(fmt::format("<enableBLOB device=\"{}\" name=\"CCD1\">Also</enableBLOB>\n",
                   xml_escaped(device)));
}

void Client::send_numbers(const Property& property, std::span<const NumberWish> wishes) {
  std::string text = fmt::format("<newNumberVector device=\"{}\" name=\"{}\">\n",
                                 xml_escaped(property.device), xml_escaped(property.name));
  for (const auto& [name, number] : wishes) {
    if (property.find(name) == nullptr) {
      throw Error(ErrorCode::unsupported,
                  fmt::format("{} of {} has no {}", property.name, property.device, name));
    }
  }
  for (const Value& value : property.values) {
    const auto wish = std::find_if(wishes.begin(), wishes.end(),
                                   [&](const NumberWish& w) { return w.first == value.name; });
    if (wish == wishes.end() && std::isnan(value.number)) continue;
    text += fmt::format("<oneNumber name=\"{}\">{}</oneNumber>\n", xml_escaped(value.name),
                        wish == wishes.end() ? value.number : wish->second);
  }
  devices_.forget_message(property.device);
  send(text + "</newNumberVector>\n");
}

void Client::send_switch(const Property& property, const std::string& value, bool is_on) {
  if (property.find(value) == nullptr) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{} of {} has no {}", property.name, property.device, value));
  }
  devices_.forget_message(property.device);
  send(
      fmt::format("<newSwitchVector device=\"{}\" name=\"{}\">\n"
                  "<oneSwitch name=\"{}\">{}</oneSwitch>\n</newSwitchVector>\n",
                  xml_escaped(property.device), xml_escaped(property.name), xml_escaped(value),
                  is_on ? "On" : "Off"));
}

void Client::await_answer(const std::string& device, const std::string& name, std::uint64_t before,
                          const std::function<bool(const Property&)>& is_as_wished) {
  const auto is_answered = [&] {
    const Property& property = need(device, name);
    return property.serial != before && property.state != State::busy;
  };
  if (!wait_unless_stopped(is_answered, monotonic_now_ns() + timeout_ns_)) {
    throw Error(ErrorCode::timeout,
                fmt::format("{} at {} did not answer to {} within {} s{}", device, where_, name,
                            static_cast<double>(timeout_ns_) * 1e-9, words_of(device)));
  }
  // A driver may repeat the answer to what was asked before; then the true one is on its way.
  const auto is_settled = [&] {
    const Property& property = need(device, name);
    return property.state == State::alert ||
           (property.state != State::busy && is_as_wished(property));
  };
  wait_unless_stopped(is_settled, monotonic_now_ns() + std::min(timeout_ns_, kSecondAnswer_ns));
  if (need(device, name).state == State::alert) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{} at {} refuses {}{}", device, where_, name, words_of(device)));
  }
}

void Client::set_numbers(const std::string& device, const std::string& name,
                         std::span<const NumberWish> wishes) {
  drain();
  const Property& property = need(device, name);
  const std::uint64_t before = property.serial;
  send_numbers(property, wishes);
  await_answer(device, name, before, [&](const Property& now) {
    return std::all_of(wishes.begin(), wishes.end(), [&](const NumberWish& wish) {
      const Value* const value = now.find(wish.first);
      return value != nullptr && value->number == wish.second;
    });
  });
}

void Client::set_switch(const std::string& device, const std::string& name,
                        const std::string& value) {
  drain();
  const Property& property = need(device, name);
  const std::uint64_t before = property.serial;
  send_switch(property, value);
  await_answer(device, name, before, [&](const Property& now) {
    const Value* const wished = now.find(value);
    return wished != nullptr && wished->is_on;
  });
}

std::string Client::words_of(const std::string& device) const {
  const std::string words = devices_.message(device);
  return words.empty() ? "" : fmt::format(": \"{}\"", words);
}

}  // namespace fathom::indi
