// SPDX-License-Identifier: Apache-2.0
// What every simulated device does: it has descriptors, answers the standard requests of endpoint
// 0, can be unplugged, and keeps the transfers that the host waits for until there is data.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "bytes.hpp"
#include "link.hpp"

namespace fathom::usb {

/// Nanoseconds of CLOCK_MONOTONIC, the clock of everything simulated here.
std::int64_t now_ns();

/// What a device is called and consists of.
struct Identity {
  std::uint16_t vendor = 0, product = 0, version = 0x0100;
  std::uint8_t device_class = 0, subclass = 0, protocol = 0;
  std::string maker, name, serial;
  Bytes configuration;  ///< With its interfaces and endpoints.
};

class Device {
 public:
  explicit Device(Identity identity) : identity_(std::move(identity)) {}
  virtual ~Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  void plug();
  void unplug();
  bool plugged() const { return link_ != nullptr; }
  int descriptor() const { return link_ ? link_->descriptor() : -1; }

  /// Answers one message of the host; call it when the descriptor is readable.
  void serve();

  /// When run() wants to be called next; the largest number where it need not be.
  virtual std::int64_t due_ns() const { return INT64_MAX; }
  virtual void run() {}

  /// Faults of endpoint 0: the next `count` class and vendor requests are refused (STALL), or
  /// never answered (the host gives up after its own time).
  void refuse_requests(int count) { refuse_ = count; }
  void ignore_requests(int count) { ignore_ = count; }

 protected:
  /// A class or vendor request. Nothing (false) is a STALL.
  virtual std::optional<Bytes> read_request(const Setup&) { return std::nullopt; }
  virtual bool write_request(const Setup&, const Bytes&) { return false; }
  /// The host starts afresh with an endpoint, or no longer waits for anything on it.
  virtual void endpoint_idle() {}

  /// Whether the host waits for data of an endpoint (not endpoint 0), and giving it some.
  bool wanted(int endpoint) const;
  std::uint32_t wanted_length(int endpoint) const;
  void give(int endpoint, const Bytes& data);

 private:
  std::deque<Transfer>::const_iterator waiting(int endpoint) const;
  void take(const Transfer& transfer);
  void forget(const Message& unlink);
  void remember_unlinked(std::uint32_t id);
  bool was_unlinked(std::uint32_t id) const;
  void control(const Transfer& transfer);
  std::optional<Bytes> standard_request(const Setup& setup);
  Bytes device_descriptor() const;
  std::optional<Bytes> string_descriptor(int index) const;

  Identity identity_;
  std::unique_ptr<Link> link_;
  std::deque<Transfer> waiting_;
  std::deque<std::uint32_t> unlinked_;  // Before they came, or after they were answered.
  int refuse_ = 0, ignore_ = 0;
};

}  // namespace fathom::usb
