// SPDX-License-Identifier: Apache-2.0
#include "device.hpp"

#include <time.h>

#include <algorithm>
#include <cerrno>
#include <utility>

namespace fathom::usb {

namespace {

enum StandardRequest {
  get_status = 0,
  clear_feature = 1,
  set_feature = 3,
  set_address = 5,
  get_descriptor = 6,
  set_configuration = 9,
  set_interface = 11,
};
enum DescriptorType { device_type = 1, configuration_type = 2, string_type = 3 };

bool is_standard(const Setup& setup) { return (setup.type & 0x60) == 0; }

}  // namespace

std::int64_t now_ns() {
  timespec time;
  ::clock_gettime(CLOCK_MONOTONIC, &time);
  return time.tv_sec * std::int64_t{1'000'000'000} + time.tv_nsec;
}

void Device::plug() {
  if (!link_) link_ = std::make_unique<Link>();
}

void Device::unplug() {
  link_.reset();
  waiting_.clear();
  unlinked_.clear();
  endpoint_idle();
}

void Device::serve() {
  const std::optional<Message> message = link_->receive();
  if (!message) return unplug();  // The host pulled it: usbip detach.
  if (message->unlink) return forget(*message);
  if (was_unlinked(message->transfer.id)) return;
  if (message->transfer.endpoint == 0) return control(message->transfer);
  take(message->transfer);
}

void Device::take(const Transfer& transfer) {
  if (transfer.in) {
    waiting_.push_back(transfer);
  } else {
    link_->complete(transfer, 0);  // Nothing here listens to what is sent to it.
  }
}

void Device::forget(const Message& unlink) {
  const auto found = std::find_if(waiting_.begin(), waiting_.end(), [&](const Transfer& transfer) {
    return transfer.id == unlink.unlinked_id;
  });
  const bool was_waiting = found != waiting_.end();
  const bool was_control = was_waiting && found->endpoint == 0;
  if (was_waiting) waiting_.erase(found);
  if (!was_waiting) remember_unlinked(unlink.unlinked_id);
  link_->complete_unlink(unlink.transfer, was_waiting ? -ECONNRESET : 0);
  if (was_waiting && !was_control && waiting_.empty()) endpoint_idle();
}

// vhci-hcd may tell that a transfer is no longer wanted before it tells the transfer, for its
// thread sends what is waiting of either kind in turn. It has given such a transfer back by our
// answer; a second one would make it pull the plug ("cannot find a urb").
void Device::remember_unlinked(std::uint32_t id) {
  constexpr std::size_t remembered = 64;
  unlinked_.push_back(id);
  if (unlinked_.size() > remembered) unlinked_.pop_front();
}

bool Device::was_unlinked(std::uint32_t id) const {
  return std::find(unlinked_.begin(), unlinked_.end(), id) != unlinked_.end();
}

void Device::control(const Transfer& transfer) {
  const Setup& setup = transfer.setup;
  if (!is_standard(setup) && ignore_ > 0) {
    --ignore_;
    waiting_.push_back(transfer);  // Until the host unlinks it.
    return;
  }
  const bool refused = !is_standard(setup) && refuse_ > 0 && refuse_-- > 0;
  std::optional<Bytes> answer;
  if (is_standard(setup)) {
    answer = standard_request(setup);
  } else if (!refused && setup.in()) {
    answer = read_request(setup);
  } else if (!refused && write_request(setup, transfer.data)) {
    answer = Bytes{};
  }
  link_->complete(transfer, answer ? 0 : -EPIPE, answer.value_or(Bytes{}));
}

std::optional<Bytes> Device::standard_request(const Setup& setup) {
  switch (setup.request) {
    case get_status:
      return Bytes{0, 0};
    case get_descriptor:
      if (setup.value >> 8 == device_type) return device_descriptor();
      if (setup.value >> 8 == configuration_type) return identity_.configuration;
      if (setup.value >> 8 == string_type) return string_descriptor(setup.value & 0xff);
      return std::nullopt;
    case clear_feature:
    case set_configuration:
    case set_interface:
      endpoint_idle();
      return Bytes{};
    case set_feature:
    case set_address:
      return Bytes{};
    default:
      return std::nullopt;
  }
}

Bytes Device::device_descriptor() const {
  Bytes bytes{18, device_type};
  append_number(bytes, 0x0200, 2);
  append(bytes, {identity_.device_class, identity_.subclass, identity_.protocol, 64});
  append_number(bytes, identity_.vendor, 2);
  append_number(bytes, identity_.product, 2);
  append_number(bytes, identity_.version, 2);
  append(bytes, {1, 2, 3, 1});  // Strings: maker, name, serial number. One configuration.
  return bytes;
}

std::optional<Bytes> Device::string_descriptor(int index) const {
  if (index == 0) return Bytes{4, string_type, 0x09, 0x04};  // English.
  const std::string* const texts[] = {&identity_.maker, &identity_.name, &identity_.serial};
  if (index > 3) return std::nullopt;
  Bytes bytes{0, string_type};
  for (const char letter : *texts[index - 1]) append_number(bytes, letter, 2);
  bytes[0] = static_cast<std::uint8_t>(bytes.size());
  return bytes;
}

std::deque<Transfer>::const_iterator Device::waiting(int endpoint) const {
  return std::find_if(waiting_.begin(), waiting_.end(),
                      [&](const Transfer& transfer) { return transfer.endpoint == endpoint; });
}

bool Device::wanted(int endpoint) const { return waiting(endpoint) != waiting_.end(); }

std::uint32_t Device::wanted_length(int endpoint) const {
  const auto transfer = waiting(endpoint);
  return transfer == waiting_.end() ? 0 : transfer->length;
}

void Device::give(int endpoint, const Bytes& data) {
  const auto transfer = waiting(endpoint);
  if (transfer == waiting_.end()) return;
  const Transfer answered = *transfer;
  waiting_.erase(transfer);
  link_->complete(answered, 0, data);
}

}  // namespace fathom::usb
