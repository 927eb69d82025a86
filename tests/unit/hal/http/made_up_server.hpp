// SPDX-License-Identifier: Apache-2.0
// A server that answers every request with the same bytes, or with none.
#pragma once

#include <atomic>
#include <string>
#include <thread>

namespace fathom::test {

class MadeUpServer {
 public:
  /// Empty: it takes every connection and says nothing.
  explicit MadeUpServer(std::string answer);
  MadeUpServer(const MadeUpServer&) = delete;
  MadeUpServer& operator=(const MadeUpServer&) = delete;
  ~MadeUpServer();

  /// A rig text that names it.
  std::string text() const;

 private:
  void serve();
  void answer(int connection) const;

  std::string answer_;
  std::atomic<bool> is_ending_ = false;
  int listener_ = -1;
  int port_ = 0;
  std::thread thread_;
};

/// An answer of HTTP with a JSON body.
std::string http_answer(const std::string& status, const std::string& body);

}  // namespace fathom::test
