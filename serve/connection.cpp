// SPDX-License-Identifier: Apache-2.0
#include "serve/connection.hpp"

#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "hal/clock.hpp"

namespace fathom::serve {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;

/// Whether the socket is ready for `wanted` within this time; a client that is gone is not.
bool wait_for(socket_t socket, short wanted, int timeout_ms) {
  pollfd one{.fd = socket, .events = static_cast<short>(wanted | POLLRDHUP), .revents = 0};
  int ready = 0;
  do {
    ready = ::poll(&one, 1, timeout_ms);
  } while (ready < 0 && errno == EINTR);
  return ready > 0 && (one.revents & wanted) != 0;
}

bool is_gone(socket_t socket) {
  pollfd one{.fd = socket, .events = POLLRDHUP, .revents = 0};
  return ::poll(&one, 1, 0) > 0 && (one.revents & (POLLRDHUP | POLLHUP | POLLERR)) != 0;
}

void name_of(const sockaddr_storage& address, socklen_t length, std::string& ip, int& port) {
  std::array<char, NI_MAXHOST> host{};
  std::array<char, NI_MAXSERV> service{};
  const auto* const generic = reinterpret_cast<const sockaddr*>(&address);
  if (::getnameinfo(generic, length, host.data(), host.size(), service.data(), service.size(),
                    NI_NUMERICHOST | NI_NUMERICSERV) != 0)
    return;
  ip = host.data();
  port = std::atoi(service.data());
}

}  // namespace

Connection::Connection(socket_t socket, const ConnectionLimits& limits)
    : socket_(socket),
      limits_(limits),
      deadline_ns_(monotonic_now_ns() + limits.request_ms * kMillisecond) {}

bool Connection::begins_another() {
  if (trouble_ != Trouble::none) return false;
  if (begin_ == end_ && !wait_for(socket_, POLLIN, limits_.idle_ms)) return false;
  head_ = body_ = 0;
  line_ends_ = 0;
  has_written_ = false;
  deadline_ns_ = monotonic_now_ns() + limits_.request_ms * kMillisecond;
  return true;
}

bool Connection::is_readable() const { return begin_ < end_ || wait_for(socket_, POLLIN, 0); }

bool Connection::is_writable() const {
  return !is_gone(socket_) && wait_for(socket_, POLLOUT, limits_.write_ms);
}

ssize_t Connection::fail(Trouble trouble) {
  if (trouble_ == Trouble::none) trouble_ = trouble;
  return -1;
}

/// Whether there is something to read now.
bool Connection::fill() {
  if (begin_ < end_) return true;
  const std::int64_t left_ms = (deadline_ns_ - monotonic_now_ns()) / kMillisecond;
  if (left_ms <= 0 || !wait_for(socket_, POLLIN, static_cast<int>(left_ms))) {
    fail(is_gone(socket_) ? Trouble::gone : Trouble::slow);
    return false;
  }
  const ssize_t got = ::recv(socket_, buffer_.data(), buffer_.size(), MSG_DONTWAIT);
  if (got <= 0) {
    fail(Trouble::gone);
    return false;
  }
  begin_ = 0;
  end_ = static_cast<std::size_t>(got);
  return true;
}

void Connection::count(char byte) {
  constexpr int kEndOfHead = 2;
  if (line_ends_ == kEndOfHead) {
    if (++body_ > limits_.body_bytes) fail(Trouble::large_body);
    return;
  }
  if (++head_ > limits_.head_bytes) fail(Trouble::large_head);
  if (byte == '\n') {
    ++line_ends_;
  } else if (byte != '\r') {
    line_ends_ = 0;
  }
}

ssize_t Connection::read(char* bytes, std::size_t size) {
  if (trouble_ != Trouble::none || !fill()) return -1;
  const std::size_t taken = std::min(size, end_ - begin_);
  for (std::size_t i = 0; i < taken; ++i) count(buffer_[begin_ + i]);
  if (trouble_ != Trouble::none) return -1;
  std::copy_n(buffer_.data() + begin_, taken, bytes);
  begin_ += taken;
  return static_cast<ssize_t>(taken);
}

ssize_t Connection::write(const char* bytes, std::size_t size) {
  if (trouble_ != Trouble::none && !has_written_) return static_cast<ssize_t>(size);
  has_written_ = true;
  if (!wait_for(socket_, POLLOUT, limits_.write_ms)) return -1;
  const ssize_t sent = ::send(socket_, bytes, size, MSG_NOSIGNAL | MSG_DONTWAIT);
  if (sent < 0 && (errno == EAGAIN || errno == EINTR)) return 0;
  return sent;
}

void Connection::answer(std::string_view text) {
  has_written_ = true;
  ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

void Connection::get_remote_ip_and_port(std::string& ip, int& port) const {
  sockaddr_storage address{};
  socklen_t length = sizeof address;
  if (::getpeername(socket_, reinterpret_cast<sockaddr*>(&address), &length) == 0)
    name_of(address, length, ip, port);
}

void Connection::get_local_ip_and_port(std::string& ip, int& port) const {
  sockaddr_storage address{};
  socklen_t length = sizeof address;
  if (::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &length) == 0)
    name_of(address, length, ip, port);
}

void close_gently(socket_t socket) {
  constexpr int kPatience_ms = 200, kMostReads = 64;
  ::shutdown(socket, SHUT_WR);
  std::array<char, 4096> rest{};
  for (int i = 0; i < kMostReads; ++i) {
    pollfd one{.fd = socket, .events = POLLIN, .revents = 0};
    if (::poll(&one, 1, kPatience_ms) <= 0) break;
    if (::recv(socket, rest.data(), rest.size(), MSG_DONTWAIT) <= 0) break;
  }
  ::close(socket);
}

void turn_away(socket_t socket, std::string_view text) {
  ::send(socket, text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  ::shutdown(socket, SHUT_WR);
  std::array<char, 4096> rest{};
  while (::recv(socket, rest.data(), rest.size(), MSG_DONTWAIT) > 0) {
  }
  ::close(socket);
}

}  // namespace fathom::serve
