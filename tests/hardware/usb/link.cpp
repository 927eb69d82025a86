// SPDX-License-Identifier: Apache-2.0
#include "link.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace fathom::usb {

namespace {

const std::string controller = "/sys/devices/platform/vhci_hcd.0/";

enum Command : std::uint32_t { submit = 1, unlink = 2, submit_result = 3, unlink_result = 4 };

constexpr int device_id = 0x10001;  // Bus 1, device 1: nobody but the kernel's log looks.
constexpr int high_speed = 3;

// Lines of the file: "hs  0000 004 ...", 004 for a free port.
int free_port() {
  std::ifstream status(controller + "status");
  if (!status) throw std::runtime_error("no vhci-hcd here: try modprobe vhci-hcd");
  std::string line;
  while (std::getline(status, line)) {
    std::istringstream words(line);
    std::string speed;
    int port = 0, state = 0;
    if (words >> speed >> port >> state && speed == "hs" && state == 4) return port;
  }
  throw std::runtime_error("vhci-hcd has no free port");
}

void attach(int socket) {
  const std::string what = std::to_string(free_port()) + ' ' + std::to_string(socket) + ' ' +
                           std::to_string(device_id) + ' ' + std::to_string(high_speed);
  const int file = ::open((controller + "attach").c_str(), O_WRONLY | O_CLOEXEC);
  const bool attached =
      file >= 0 && ::write(file, what.data(), what.size()) == static_cast<ssize_t>(what.size());
  const int error = errno;
  if (file >= 0) ::close(file);
  if (!attached) {
    throw std::runtime_error(std::string("vhci-hcd takes no device: ") + std::strerror(error));
  }
}

Setup unpack_setup(const std::uint8_t* bytes) {
  const auto word = [&](int at) {
    return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8);
  };
  return {bytes[0], bytes[1], word(2), word(4), word(6)};
}

}  // namespace

Link::Link() {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    throw std::runtime_error("no socket pair for the USB link");
  }
  socket_ = ends[0];
  try {
    attach(ends[1]);  // The kernel keeps its own reference to that end.
  } catch (...) {
    ::close(ends[1]);
    ::close(socket_);
    throw;
  }
  ::close(ends[1]);
}

Link::~Link() {
  ::shutdown(socket_, SHUT_RDWR);
  ::close(socket_);
}

std::optional<Message> Link::receive() {
  Header header;
  if (!read_all(header.data(), sizeof header)) return std::nullopt;
  Message message;
  Transfer& transfer = message.transfer;
  transfer.id = ntohl(header[1]);
  if (ntohl(header[0]) == unlink) {
    message.unlink = true;
    message.unlinked_id = ntohl(header[5]);
    return message;
  }
  transfer.in = ntohl(header[3]) != 0;
  transfer.endpoint = static_cast<int>(ntohl(header[4]));
  transfer.length = ntohl(header[6]);
  transfer.setup = unpack_setup(reinterpret_cast<const std::uint8_t*>(&header[10]));
  if (!transfer.in && transfer.length > 0) {
    transfer.data.resize(transfer.length);
    if (!read_all(transfer.data.data(), transfer.data.size())) return std::nullopt;
  }
  return message;
}

void Link::complete(const Transfer& transfer, int status, const Bytes& data) {
  const std::size_t sent = transfer.in ? std::min<std::size_t>(data.size(), transfer.length) : 0;
  const std::size_t done = status != 0 ? 0 : transfer.in ? sent : transfer.length;
  Header header{};
  header[0] = htonl(submit_result);
  header[1] = htonl(transfer.id);
  header[5] = htonl(static_cast<std::uint32_t>(status));
  header[6] = htonl(static_cast<std::uint32_t>(done));
  write_all(header.data(), sizeof header);
  if (status == 0) write_all(data.data(), sent);
}

void Link::complete_unlink(const Transfer& unlinked, int status) {
  Header header{};
  header[0] = htonl(unlink_result);
  header[1] = htonl(unlinked.id);
  header[5] = htonl(static_cast<std::uint32_t>(status));
  write_all(header.data(), sizeof header);
}

bool Link::read_all(void* to, std::size_t size) {
  auto* at = static_cast<char*>(to);
  while (size > 0) {
    const ssize_t got = ::recv(socket_, at, size, MSG_WAITALL);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    at += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

// A host that is gone is noticed when reading.
void Link::write_all(const void* from, std::size_t size) {
  const auto* at = static_cast<const char*>(from);
  while (size > 0) {
    const ssize_t put = ::send(socket_, at, size, MSG_NOSIGNAL);
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return;
    at += put;
    size -= static_cast<std::size_t>(put);
  }
}

}  // namespace fathom::usb
