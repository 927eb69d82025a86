// SPDX-License-Identifier: Apache-2.0
// The cable between a simulated device and this machine's USB: the kernel's vhci-hcd is a host
// controller whose devices are at the other end of a socket (the USB/IP protocol).
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "bytes.hpp"

namespace fathom::usb {

/// The eight bytes that open a control transfer.
struct Setup {
  std::uint8_t type = 0;
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
  std::uint16_t length = 0;

  bool in() const { return (type & 0x80) != 0; }
};

/// What the host asks of one endpoint.
struct Transfer {
  std::uint32_t id = 0;
  int endpoint = 0;
  bool in = false;
  std::uint32_t length = 0;  ///< Bytes that it sends or takes.
  Setup setup;               ///< Of endpoint 0.
  Bytes data;                ///< What it sends.
};

/// What the host says: a transfer, or that it no longer waits for one.
struct Message {
  bool unlink = false;
  Transfer transfer;  ///< Only its id where `unlink`.
  std::uint32_t unlinked_id = 0;
};

class Link {
 public:
  /// Plugs a high-speed device into a free port of vhci-hcd. Throws std::runtime_error.
  Link();
  /// Pulls it out.
  ~Link();
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  int descriptor() const { return socket_; }  ///< Readable when there is a message.

  /// Waits for the next message; nothing when the host closed the link.
  std::optional<Message> receive();

  /// Ends a transfer. status: 0 or a negative errno; -EPIPE is a STALL.
  void complete(const Transfer& transfer, int status, const Bytes& data = {});
  /// Answers an unlink: -ECONNRESET if the transfer was still waiting, 0 if it was done before.
  void complete_unlink(const Transfer& unlink, int status);

 private:
  using Header = std::array<std::uint32_t, 12>;

  bool read_all(void* to, std::size_t size);
  void write_all(const void* from, std::size_t size);

  int socket_ = -1;
};

}  // namespace fathom::usb
