// SPDX-License-Identifier: Apache-2.0
#include "made_up_server.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <utility>
#include <vector>

namespace fathom::test {

MadeUpServer::MadeUpServer(std::string answer)
    : answer_(std::move(answer)), listener_(socket(AF_INET, SOCK_STREAM, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  bind(listener_, reinterpret_cast<sockaddr*>(&address), size);
  getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
  listen(listener_, 8);
  port_ = ntohs(address.sin_port);
  thread_ = std::thread([this] { serve(); });
}

MadeUpServer::~MadeUpServer() {
  is_ending_ = true;
  thread_.join();
  close(listener_);
}

std::string MadeUpServer::text() const {
  return fmt::format("http://127.0.0.1:{}?token=12345678", port_);
}

void MadeUpServer::answer(int connection) const {
  std::array<char, 4096> request;
  if (recv(connection, request.data(), request.size(), 0) > 0)
    send(connection, answer_.data(), answer_.size(), MSG_NOSIGNAL);
}

void MadeUpServer::serve() {
  std::vector<int> silent;
  while (!is_ending_) {
    pollfd wanted{listener_, POLLIN, 0};
    if (poll(&wanted, 1, 20) <= 0) continue;
    const int connection = accept(listener_, nullptr, nullptr);
    if (answer_.empty()) {
      silent.push_back(connection);
      continue;
    }
    answer(connection);
    close(connection);
  }
  for (const int connection : silent) close(connection);
}

std::string http_answer(const std::string& status, const std::string& body) {
  return fmt::format("HTTP/1.1 {}\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{}", status,
                     body.size(), body);
}

}  // namespace fathom::test
