// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/indi/devices.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>

#include "engine/error.hpp"

namespace fathom::indi {
namespace {

// A large server has some thousands; with the limits of XmlStream this bounds the memory.
constexpr std::size_t kMostValues = 50'000;
constexpr std::size_t kMostDevices = 1000;
constexpr std::size_t kLongestText = 4096;
constexpr std::size_t kLongestName = 256;

constexpr std::pair<std::string_view, Kind> kKinds[] = {{"Number", Kind::number},
                                                        {"Switch", Kind::toggle},
                                                        {"Text", Kind::text},
                                                        {"Light", Kind::light},
                                                        {"BLOB", Kind::blob}};

std::optional<Kind> kind_of(std::string_view tag, std::string_view verb) {
  if (!tag.starts_with(verb) || !tag.ends_with("Vector")) return std::nullopt;
  const std::string_view word = tag.substr(verb.size(), tag.size() - verb.size() - 6);
  for (const auto& [name, kind] : kKinds) {
    if (word == name) return kind;
  }
  return std::nullopt;
}

std::optional<State> state_of(const Element& element) {
  const std::string state = element.attribute("state");
  if (state == "Idle") return State::idle;
  if (state == "Ok") return State::ok;
  if (state == "Busy") return State::busy;
  if (state == "Alert") return State::alert;
  return std::nullopt;  // may be left out where it does not change
}

/// NaN for what is no plain decimal number, the sexagesimal ones of telescopes among them.
double number_of(std::string_view text) {
  double number = 0;
  const char* const end = text.data() + text.size();
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [next, problem] = std::from_chars(text.data(), end, number);
  const bool is_number = problem == std::errc() && next == end;
  return is_number ? number : std::numeric_limits<double>::quiet_NaN();
}

void read_value(Value& value, const Member& member, Kind kind) {
  if (kind == Kind::number) value.number = number_of(member.text);
  if (kind == Kind::toggle) value.is_on = member.text == "On";
  if (kind == Kind::text) value.text = member.text.substr(0, kLongestText);
}

}  // namespace

const Value* Property::find(std::string_view value) const {
  const auto at = std::find_if(values.begin(), values.end(),
                               [&](const Value& candidate) { return candidate.name == value; });
  return at == values.end() ? nullptr : &*at;
}

const Property* Devices::find(const std::string& device, const std::string& name) const {
  const auto at = all_.find({device, name});
  return at == all_.end() ? nullptr : &at->second;
}

std::vector<std::string> Devices::names() const {
  std::vector<std::string> devices;
  for (const auto& [key, property] : all_) {
    if (devices.empty() || devices.back() != key.first) devices.push_back(key.first);
  }
  return devices;
}

std::string Devices::message(const std::string& device) const {
  const auto at = messages_.find(device);
  return at == messages_.end() ? "" : at->second;
}

void Devices::take(Element element) {
  const std::string message = element.attribute("message");
  const std::string device = element.attribute("device");
  if (!message.empty() && (messages_.size() < kMostDevices || messages_.contains(device))) {
    messages_[device] = message.substr(0, 200);
  }
  if (const auto kind = kind_of(element.tag, "def")) {
    define(element, *kind);
  } else if (element.tag == "delProperty") {
    remove(element);
  } else if (kind_of(element.tag, "set")) {
    change(element);
  }
}

void Devices::define(const Element& element, Kind kind) {
  Property property;
  property.device = element.attribute("device");
  property.name = element.attribute("name");
  property.kind = kind;
  property.state = state_of(element).value_or(State::idle);
  property.is_writable = element.attribute("perm") != "ro";
  for (const Member& member : element.members) {
    Value& value = property.values.emplace_back();
    value.name = member.attribute("name").substr(0, kLongestName);
    value.lowest = number_of(member.attribute("min"));
    value.highest = number_of(member.attribute("max"));
    value.step = number_of(member.attribute("step"));
    read_value(value, member, kind);
  }
  if (std::max(property.device.size(), property.name.size()) > kLongestName) return;
  Property& place = all_[{property.device, property.name}];
  values_ += property.values.size() + 1 - (place.name.empty() ? 0 : place.values.size() + 1);
  if (values_ > kMostValues) {
    throw Error(ErrorCode::bad_data,
                fmt::format("the INDI server defines more than {} values", kMostValues));
  }
  property.serial = ++statements_;
  if (property.state == State::busy) property.busy_serial = property.serial;
  place = std::move(property);
  ++definitions_;
}

void Devices::change(Element& element) {
  const auto at = all_.find({element.attribute("device"), element.attribute("name")});
  if (at == all_.end() || kind_of(element.tag, "set") != at->second.kind) return;
  Property& property = at->second;
  property.state = state_of(element).value_or(property.state);
  property.serial = ++statements_;
  if (property.state == State::busy) property.busy_serial = property.serial;
  for (Member& member : element.members) {
    const std::string name = member.attribute("name");
    if (property.kind == Kind::blob && name == "CCD1") {
      picture_ = Blob{std::move(member.bytes), member.attribute("format"), 0, member.is_damaged};
      const std::string size = member.attribute("size");
      std::from_chars(size.data(), size.data() + size.size(), picture_->size);
    }
    for (Value& value : property.values) {
      if (value.name == name) read_value(value, member, property.kind);
    }
  }
}

void Devices::remove(const Element& element) {
  const std::string device = element.attribute("device");
  const std::string name = element.attribute("name");
  // Without a name: all of the device, which indiserver also says of a driver that has crashed.
  for (auto at = all_.lower_bound({device, name}); at != all_.end();) {
    if (at->first.first != device || (!name.empty() && at->first.second != name)) break;
    values_ -= at->second.values.size() + 1;
    at = all_.erase(at);
  }
}

}  // namespace fathom::indi
