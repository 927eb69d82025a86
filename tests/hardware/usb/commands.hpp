// SPDX-License-Identifier: Apache-2.0
// Commands to running devices: one line each way over a Unix socket.
#pragma once

#include <functional>
#include <string>

namespace fathom::usb {

/// Takes one connection at a time and answers its one line.
class CommandSocket {
 public:
  /// Makes the socket; what was at that path is replaced. Throws std::runtime_error.
  explicit CommandSocket(const std::string& path);
  ~CommandSocket();
  CommandSocket(const CommandSocket&) = delete;
  CommandSocket& operator=(const CommandSocket&) = delete;

  int descriptor() const { return socket_; }  ///< Readable when somebody connects.
  void serve(const std::function<std::string(const std::string&)>& answer);

 private:
  std::string path_;
  int socket_ = -1;
};

/// Sends a command and returns the answer. Throws std::runtime_error if there is none within 5 s.
std::string command(const std::string& path, const std::string& line);

}  // namespace fathom::usb
