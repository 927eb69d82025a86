// SPDX-License-Identifier: Apache-2.0
#include "hal/socket.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <future>
#include <memory>
#include <thread>
#include <utility>

#include "engine/error.hpp"
#include "hal/clock.hpp"

namespace fathom {
namespace {

constexpr std::int64_t kMillisecond_ns = 1'000'000;
constexpr std::int64_t kSlice_ns = 50 * kMillisecond_ns;  // how soon a wish to stop is seen

using Addresses = std::shared_ptr<addrinfo>;

struct Resolved {
  int status = 0;
  Addresses list;
};

Resolved resolve_now(const Address& address, int flags) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = flags | AI_NUMERICSERV;
  addrinfo* list = nullptr;
  const int status = getaddrinfo(address.host.c_str(), address.port.c_str(), &hints, &list);
  return {status, Addresses(list, [](addrinfo* l) {
            if (l != nullptr) freeaddrinfo(l);
          })};
}

void require_going(const StopWatch& stop, const Peer& peer) {
  if (!stop.stopped()) return;
  throw Error(ErrorCode::cancelled,
              fmt::format("stopped on request while {} was asked", peer.address.text()));
}

/// Asking for a name cannot be given a deadline, so a thread asks, and is left behind if nobody
/// answers it: it holds nothing but its own question.
Resolved resolve(const Peer& peer, std::int64_t deadline_ns, const StopRequests& requests) {
  const Address& address = peer.address;
  if (Resolved numeric = resolve_now(address, AI_NUMERICHOST); numeric.status == 0) return numeric;
  std::packaged_task<Resolved()> task([address] { return resolve_now(address, 0); });
  std::future<Resolved> answer = task.get_future();
  std::thread(std::move(task)).detach();
  const StopWatch stop(requests);
  const std::chrono::nanoseconds slice(kSlice_ns);
  while (answer.wait_for(slice) != std::future_status::ready) {
    require_going(stop, peer);
    if (monotonic_now_ns() < deadline_ns) continue;
    throw Error(ErrorCode::timeout,
                fmt::format("no answer to where the {} is; is its name right?", peer.text()));
  }
  return answer.get();
}

}  // namespace

std::optional<Address> parse_address(std::string_view text, std::string_view usual_port) {
  Address address{.host = "", .port = std::string(usual_port)};
  const bool is_v6 = text.starts_with('[');
  const std::size_t end = is_v6 ? text.find(']') : text.find(':');
  std::string_view rest;
  if (end != std::string_view::npos) rest = text.substr(end + (is_v6 ? 1 : 0));
  address.host = text.substr(is_v6 ? 1 : 0, end - (is_v6 && end != std::string_view::npos ? 1 : 0));
  if (!rest.empty()) address.port = rest.substr(1);
  const bool is_number = !address.port.empty() && address.port.size() <= 5 &&
                         std::all_of(address.port.begin(), address.port.end(),
                                     [](char c) { return c >= '0' && c <= '9'; }) &&
                         std::stoi(address.port) >= 1 && std::stoi(address.port) <= 65535;
  const bool is_host =
      !address.host.empty() && address.host.find_first_of(",= ") == std::string::npos;
  const bool is_sound = is_host && is_number && !(is_v6 && end == std::string_view::npos) &&
                        (rest.empty() || rest[0] == ':');
  return is_sound ? std::optional(std::move(address)) : std::nullopt;
}

Socket::Socket(Peer peer, std::int64_t deadline_ns, const StopRequests& stop_requests)
    : peer_(std::move(peer)), stop_requests_(stop_requests) {
  const Resolved resolved = resolve(peer_, deadline_ns, stop_requests_);
  if (resolved.status != 0) {
    throw Error(ErrorCode::unavailable,
                fmt::format("no {} at {}: {}; is the name right?", peer_.kind, peer_.address.text(),
                            gai_strerror(resolved.status)));
  }
  for (const addrinfo* target = resolved.list.get(); target != nullptr; target = target->ai_next) {
    if (connect_to(*target, deadline_ns)) return;
  }
  throw Error(problem_ == ETIMEDOUT ? ErrorCode::timeout : ErrorCode::unavailable,
              fmt::format("no {} at {}: {}; {}", peer_.kind, peer_.address.text(),
                          std::strerror(problem_), peer_.advice));
}

Socket::~Socket() {
  if (handle_ >= 0) close(handle_);
}

bool Socket::connect_to(const addrinfo& target, std::int64_t deadline_ns) {
  if (handle_ >= 0) close(handle_);
  handle_ = socket(target.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (handle_ < 0) {
    problem_ = errno;
    return false;
  }
  const int yes = 1;  // a request is a packet of its own, and an exposure begins with one
  setsockopt(handle_, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  if (connect(handle_, target.ai_addr, target.ai_addrlen) == 0) return true;
  problem_ = errno;
  if (problem_ != EINPROGRESS) return false;
  problem_ = ETIMEDOUT;
  if (!wait_in_slices(POLLOUT, deadline_ns)) return false;
  socklen_t size = sizeof problem_;
  getsockopt(handle_, SOL_SOCKET, SO_ERROR, &problem_, &size);
  return problem_ == 0;
}

bool Socket::wait_for(short events, std::int64_t deadline_ns) const {
  for (;;) {
    const std::int64_t left_ns = std::max<std::int64_t>(deadline_ns - monotonic_now_ns(), 0);
    const std::int64_t left_ms = (left_ns + kMillisecond_ns - 1) / kMillisecond_ns;
    pollfd wanted{handle_, events, 0};
    const int ready = poll(&wanted, 1, static_cast<int>(std::min<std::int64_t>(left_ms, 60'000)));
    if (ready > 0) return true;
    if (monotonic_now_ns() >= deadline_ns) return false;
  }
}

bool Socket::wait_in_slices(short events, std::int64_t deadline_ns) const {
  const StopWatch stop(stop_requests_);
  for (;;) {
    const std::int64_t slice_ns = std::min(deadline_ns, monotonic_now_ns() + kSlice_ns);
    if (wait_for(events, slice_ns)) return true;
    require_going(stop, peer_);
    if (slice_ns == deadline_ns) return false;
  }
}

void Socket::send(std::string_view bytes, std::int64_t deadline_ns) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(handle_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      if (wait_in_slices(POLLOUT, deadline_ns)) continue;
      throw Error(ErrorCode::timeout,
                  fmt::format("the {} takes no request; does it hang?", peer_.text()));
    } else if (errno != EINTR) {
      throw Error(ErrorCode::device_lost,
                  fmt::format("the {} is gone: {}", peer_.text(), std::strerror(errno)));
    }
  }
}

std::size_t Socket::receive(std::span<char> room, std::int64_t deadline_ns) {
  for (;;) {
    const ssize_t received = recv(handle_, room.data(), room.size(), 0);
    if (received > 0) return static_cast<std::size_t>(received);
    if (received == 0) {
      throw Error(ErrorCode::device_lost,
                  fmt::format("the {} closed the connection; is it still running?", peer_.text()));
    }
    if (errno == EAGAIN || errno == EWOULDBLOCK) {
      if (!wait_for(POLLIN, deadline_ns)) return 0;
    } else if (errno != EINTR) {
      throw Error(ErrorCode::device_lost,
                  fmt::format("the {} is gone: {}", peer_.text(), std::strerror(errno)));
    }
  }
}

}  // namespace fathom
