// SPDX-License-Identifier: Apache-2.0
// One client's connection, which ends where its patience does: the HTTP library sets no limit on
// the size of a head, or on the time that one takes.
#pragma once

#include <httplib.h>

#include <array>
#include <cstddef>
#include <cstdint>

namespace fathom::serve {

/// What a client may cost.
struct ConnectionLimits {
  std::size_t head_bytes = 8 << 10;  ///< Of the request line and all headers.
  std::size_t body_bytes = 64 << 10;
  int request_ms = 10'000;  ///< From its beginning to the last byte of the request.
  int idle_ms = 2'000;      ///< Between two requests.
  int write_ms = 10'000;    ///< How long a client may take nothing of what is sent.
};

/// Why a request was not read to its end.
enum class Trouble {
  none,
  gone,        ///< The client closed.
  large_head,  ///< 431
  large_body,  ///< 413
  slow,        ///< 408
};

/// What the HTTP library reads and writes a connection by.
class Connection final : public httplib::Stream {
 public:
  /// Does not close the socket.
  Connection(socket_t socket, const ConnectionLimits& limits);

  /// Whether another request begins, which is then read. Only for one after a request that was read
  /// to its end.
  bool begins_another();

  /// What is wrong, and nothing has been answered yet.
  Trouble trouble() const { return has_written_ ? Trouble::none : trouble_; }
  /// Sends an answer that the HTTP library did not make. Errors are nobody's concern any more.
  void answer(std::string_view text);

  bool is_readable() const override;
  /// Waits until the client takes something, as long as it may; false where it is gone.
  bool is_writable() const override;
  ssize_t read(char* bytes, std::size_t size) override;
  /// After trouble nothing is written: the answer to that is another one.
  ssize_t write(const char* bytes, std::size_t size) override;
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  socket_t socket() const override { return socket_; }

 private:
  bool fill();
  void count(char byte);
  ssize_t fail(Trouble trouble);

  socket_t socket_;
  ConnectionLimits limits_;
  std::int64_t deadline_ns_;
  std::array<char, 4096> buffer_;
  std::size_t begin_ = 0, end_ = 0;  ///< Of what has arrived and was not read.
  std::size_t head_ = 0, body_ = 0;  ///< Bytes read.
  int line_ends_ = 0;                ///< The head ends with two in a row.
  Trouble trouble_ = Trouble::none;
  bool has_written_ = false;
};

/// Sends a short answer without waiting, and closes.
void turn_away(socket_t socket, std::string_view text);

/// Tells the client that nothing more will come, lets go of what it still sends, and closes: a
/// socket that is closed with bytes unread takes its answer back.
void close_gently(socket_t socket);

}  // namespace fathom::serve
