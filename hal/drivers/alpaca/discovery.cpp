// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/alpaca/discovery.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <string_view>

#include "hal/clock.hpp"

namespace fathom::alpaca {
namespace {

constexpr std::uint16_t kPort = 32227;
constexpr std::string_view kQuestion = "alpacadiscovery1";
constexpr std::int64_t kMillisecond_ns = 1'000'000;

class Socket {
 public:
  Socket() : fd_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    const int yes = 1;
    if (fd_ >= 0) ::setsockopt(fd_, SOL_SOCKET, SO_BROADCAST, &yes, sizeof yes);
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  ~Socket() {
    if (fd_ >= 0) ::close(fd_);
  }
  int fd() const { return fd_; }

 private:
  int fd_;
};

void ask(const Socket& socket, const char* whom) {
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(kPort);
  ::inet_pton(AF_INET, whom, &to.sin_addr);
  // A network that cannot be reached has no servers.
  [[maybe_unused]] const auto sent = ::sendto(socket.fd(), kQuestion.data(), kQuestion.size(), 0,
                                              reinterpret_cast<const sockaddr*>(&to), sizeof to);
}

}  // namespace

int port_in(std::string_view answer) {
  const auto json = nlohmann::json::parse(answer, nullptr, false);
  if (!json.is_object()) return 0;
  const auto port = json.find("AlpacaPort");
  if (port == json.end() || !port->is_number_integer()) return 0;
  const auto number = port->get<long long>();
  return number > 0 && number < 65536 ? static_cast<int>(number) : 0;
}

std::vector<Address> discover(std::int64_t listen_ns) {
  const Socket socket;
  if (socket.fd() < 0) return {};
  for (const char* const whom : {"255.255.255.255", "127.0.0.1"}) ask(socket, whom);
  std::vector<Address> found;
  const std::int64_t deadline_ns = monotonic_now_ns() + listen_ns;
  for (std::int64_t left_ns = listen_ns; left_ns > 0; left_ns = deadline_ns - monotonic_now_ns()) {
    pollfd wait{socket.fd(), POLLIN, 0};
    if (::poll(&wait, 1, static_cast<int>(left_ns / kMillisecond_ns + 1)) <= 0) continue;
    char answer[512];
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const auto length = ::recvfrom(socket.fd(), answer, sizeof answer, 0,
                                   reinterpret_cast<sockaddr*>(&from), &size);
    if (length <= 0) continue;
    const int port = port_in({answer, static_cast<std::size_t>(length)});
    char host[INET_ADDRSTRLEN] = "";
    if (port == 0 || ::inet_ntop(AF_INET, &from.sin_addr, host, sizeof host) == nullptr) continue;
    const bool is_known = std::any_of(found.begin(), found.end(), [&](const Address& known) {
      return known.host == host && known.port == std::to_string(port);
    });
    if (!is_known) found.push_back({host, std::to_string(port)});
  }
  return found;
}

}  // namespace fathom::alpaca
