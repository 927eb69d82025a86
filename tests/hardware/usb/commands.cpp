// SPDX-License-Identifier: Apache-2.0
#include "commands.hpp"

#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <stdexcept>

namespace fathom::usb {

namespace {

int unix_socket() {
  const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (socket < 0) throw std::runtime_error("no Unix socket");
  const timeval patience{5, 0};
  ::setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  return socket;
}

sockaddr_un address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) throw std::runtime_error(path + ": too long");
  std::memcpy(address.sun_path, path.data(), path.size());
  return address;
}

std::string read_line(int socket) {
  std::string line;
  char letter;
  while (line.size() < 4096 && ::recv(socket, &letter, 1, 0) == 1 && letter != '\n') line += letter;
  return line;
}

void write_line(int socket, std::string line) {
  line += '\n';
  ::send(socket, line.data(), line.size(), MSG_NOSIGNAL);
}

}  // namespace

CommandSocket::CommandSocket(const std::string& path) : path_(path), socket_(unix_socket()) {
  const sockaddr_un address = address_of(path);
  ::unlink(path.c_str());
  if (::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      ::listen(socket_, 4) != 0) {
    ::close(socket_);
    throw std::runtime_error("cannot listen at " + path + ": " + std::strerror(errno));
  }
}

CommandSocket::~CommandSocket() {
  ::close(socket_);
  ::unlink(path_.c_str());
}

void CommandSocket::serve(const std::function<std::string(const std::string&)>& answer) {
  const int client = ::accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC);
  if (client < 0) return;
  const timeval patience{1, 0};
  ::setsockopt(client, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  write_line(client, answer(read_line(client)));
  ::close(client);
}

std::string command(const std::string& path, const std::string& line) {
  const int socket = unix_socket();
  const sockaddr_un address = address_of(path);
  if (::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    ::close(socket);
    throw std::runtime_error("nobody listens at " + path + ": " + std::strerror(errno));
  }
  write_line(socket, line);
  const std::string answer = read_line(socket);
  ::close(socket);
  if (answer.empty()) throw std::runtime_error("no answer from " + path);
  return answer;
}

}  // namespace fathom::usb
