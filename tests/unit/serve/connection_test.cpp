// SPDX-License-Identifier: Apache-2.0
// What a connection refuses to read, byte by byte, over a pair of sockets.
#include "serve/connection.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

namespace fathom::serve {
namespace {

struct Pair {
  Pair() { EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0); }
  Pair(const Pair&) = delete;
  Pair& operator=(const Pair&) = delete;
  ~Pair() {
    ::close(ends[0]);
    ::close(ends[1]);
  }
  void send(const std::string& text) {
    EXPECT_EQ(::send(ends[1], text.data(), text.size(), 0), static_cast<ssize_t>(text.size()));
  }
  int ends[2] = {-1, -1};
};

constexpr ConnectionLimits kLimits{
    .head_bytes = 64, .body_bytes = 8, .request_ms = 50, .idle_ms = 50, .write_ms = 50};

/// Reads one byte after the other, as the HTTP library does; how many there were.
std::size_t read_all(Connection& connection) {
  std::size_t count = 0;
  for (char byte = 0; connection.read(&byte, 1) == 1;) ++count;
  return count;
}

TEST(Connection, ReadsAHeadAndABodyWithinTheirLimits) {
  Pair pair;
  Connection connection(pair.ends[0], kLimits);
  const std::string request = "POST / HTTP/1.1\r\nA: b\r\n\r\n12345678";
  pair.send(request);
  std::string got(request.size(), '\0');
  for (char& byte : got) ASSERT_EQ(connection.read(&byte, 1), 1);
  EXPECT_EQ(got, request);
  EXPECT_EQ(connection.trouble(), Trouble::none);
}

TEST(Connection, CountsEveryRequestAnew) {
  Pair pair;
  Connection connection(pair.ends[0], kLimits);
  const std::string request = "GET / HTTP/1.1\r\nA: " + std::string(30, 'a') + "\r\n\r\n";
  pair.send(request + request);
  for (int i = 0; i < 2; ++i) {
    std::string got(request.size(), '\0');
    for (char& byte : got) ASSERT_EQ(connection.read(&byte, 1), 1);
    EXPECT_EQ(got, request);
    EXPECT_EQ(connection.begins_another(), i == 0);
  }
}

TEST(Connection, EndsAHeadThatIsTooLarge) {
  Pair pair;
  Connection connection(pair.ends[0], kLimits);
  pair.send("GET / HTTP/1.1\r\nA: " + std::string(100, 'a'));
  EXPECT_EQ(read_all(connection), kLimits.head_bytes);
  EXPECT_EQ(connection.trouble(), Trouble::large_head);
}

TEST(Connection, EndsABodyThatIsTooLarge) {
  Pair pair;
  Connection connection(pair.ends[0], kLimits);
  pair.send("POST / HTTP/1.1\r\n\r\n");
  for (int i = 0; i < 19; ++i) {
    char byte = 0;
    ASSERT_EQ(connection.read(&byte, 1), 1);
  }
  pair.send("123456789");
  EXPECT_EQ(read_all(connection), 8u);
  EXPECT_EQ(connection.trouble(), Trouble::large_body);
}

TEST(Connection, TellsAClientThatIsSlowFromOneThatIsGone) {
  Pair slow;
  Connection waiting(slow.ends[0], kLimits);
  slow.send("GET /");
  EXPECT_EQ(read_all(waiting), 5u);
  EXPECT_EQ(waiting.trouble(), Trouble::slow);
  Pair gone;
  Connection left(gone.ends[0], kLimits);
  ::shutdown(gone.ends[1], SHUT_RDWR);
  EXPECT_EQ(read_all(left), 0u);
  EXPECT_EQ(left.trouble(), Trouble::gone);
  EXPECT_FALSE(left.is_writable());
}

TEST(Connection, AfterTroubleTheHttpLibrarysAnswerIsNotSent) {
  Pair pair;
  Connection connection(pair.ends[0], kLimits);
  EXPECT_EQ(read_all(connection), 0u);
  EXPECT_EQ(connection.write("HTTP/1.1 400", 12), 12);
  EXPECT_EQ(connection.trouble(), Trouble::slow);
  connection.answer("HTTP/1.1 408");
  char got[32] = {};
  EXPECT_EQ(::recv(pair.ends[1], got, sizeof got, MSG_DONTWAIT), 12);
  EXPECT_STREQ(got, "HTTP/1.1 408");
}

TEST(Connection, GivesUpOnAClientThatTakesNothing) {
  Pair pair;
  Connection connection(pair.ends[0], kLimits);
  const std::string much(1 << 20, 'x');
  ssize_t sent = 0;
  while ((sent = connection.write(much.data(), much.size())) >= 0) {
  }
  EXPECT_EQ(sent, -1);
  EXPECT_FALSE(connection.is_writable());
}

}  // namespace
}  // namespace fathom::serve
