// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/console.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>
#include <system_error>

#include "engine/error.hpp"

namespace fathom::cli {
namespace {

volatile std::sig_atomic_t interrupts = 0;

/// Two ask politely, so that a lens can be put back and a camera be given its automatic controls
/// again; the third kills.
extern "C" void on_interrupt(int signal_number) {
  interrupts = interrupts + 1;
  if (interrupts >= 2) std::signal(signal_number, SIG_DFL);
}

/// Without SA_RESTART, so that a read that waits for a person or a pipe ends too.
void on_signal(int signal_number, void (*handler)(int)) {
  struct sigaction action = {};
  action.sa_handler = handler;
  sigaction(signal_number, &action, nullptr);
}

/// Stderr may be closed or full; what cannot be said there is not worth dying for.
void say(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

/// One line stays one line, and a file name cannot command the terminal.
std::string printable(std::string_view text) {
  std::string line;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    line += byte < 0x20 || byte == 0x7f ? fmt::format("\\x{:02x}", byte) : std::string(1, c);
  }
  return line;
}

std::string quoted(std::string_view text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

template <typename Integer>
void append_integer(std::string& text, Integer value) {
  std::array<char, 24> digits;
  const auto [end, problem] = std::to_chars(digits.begin(), digits.end(), value);
  text.append(digits.begin(), end);
}

}  // namespace

void append_json(std::string& text, double value) {
  if (!std::isfinite(value)) {
    text += "null";
    return;
  }
  constexpr int kDigits = std::numeric_limits<double>::max_digits10;
  std::array<char, 32> digits;  // sign, 17 digits, point, e-308
  const auto [end, problem] =
      std::to_chars(digits.begin(), digits.end(), value, std::chars_format::general, kDigits);
  text.append(digits.begin(), end);
}
void append_json(std::string& text, int value) { append_integer(text, value); }
void append_json(std::string& text, std::size_t value) { append_integer(text, value); }

void JsonLine::append_key(std::string_view key) {
  if (!body_.empty()) body_ += ',';
  body_ += quoted(key);
  body_ += ':';
}

JsonLine& JsonLine::add(std::string_view key, std::string_view value) {
  append_key(key);
  body_ += quoted(value);
  return *this;
}
JsonLine& JsonLine::add(std::string_view key, std::span<const double> values) {
  append_key(key);
  body_ += '[';
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) body_ += ',';
    append_json(body_, values[i]);
  }
  body_ += ']';
  return *this;
}
JsonLine& JsonLine::add_members(std::string_view members) {
  if (!body_.empty()) body_ += ',';
  body_ += members;
  return *this;
}
JsonLine& JsonLine::add_json(std::string_view key, std::string_view value) {
  append_key(key);
  body_ += value;
  return *this;
}
JsonLine& JsonLine::add_null(std::string_view key) {
  append_key(key);
  body_ += "null";
  return *this;
}

void print_line(std::string_view line) {
  std::fwrite(line.data(), 1, line.size(), stdout);
  std::fputc('\n', stdout);
  flush_lines();
}

void print_lines(std::string_view lines) {
  std::fwrite(lines.data(), 1, lines.size(), stdout);
  flush_lines();
}

void flush_lines() {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return;
  throw Error(ErrorCode::io, fmt::format("cannot write to standard output: {}",
                                         std::generic_category().message(errno)));
}

void note(std::string_view text) {
  const char* const over_progress = ::isatty(STDERR_FILENO) == 1 ? "\r\033[K" : "";
  say(over_progress + ("fathom: " + printable(text) + "\n"));
}

Progress::Progress() : live_(::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() { clear(); }

void Progress::clear() {
  if (shown_) say("\r\033[K");
  shown_ = false;
}

void Progress::show(const std::function<std::string()>& text) {
  if (!live_) return;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return;
  next_ = now + std::chrono::milliseconds(50);
  std::string line = text();
  // A line that wraps could not be rewritten in place. Only ASCII is shown here, so bytes are
  // columns.
  line.resize(std::min(line.size(), static_cast<std::size_t>(terminal_columns() - 1)));
  say("\r\033[K" + line);
  shown_ = true;
}

void Progress::bar(std::string_view label, std::size_t done, std::size_t total) {
  show([&] {
    constexpr std::size_t width = 40;
    const std::size_t filled = total > 0 ? width * done / total : width;
    return fmt::format("{} [{:#>{}}{:->{}}] {} of {}", label, "", filled, "", width - filled, done,
                       total);
  });
}

int stop_requests() { return interrupts; }

void catch_signals() {
  for (const int wish : {SIGINT, SIGTERM, SIGHUP}) on_signal(wish, on_interrupt);
  // A closed pipe or a file-size limit must come back as an error of the write, not kill the
  // program before it has put the lens back and saved the run.
  on_signal(SIGPIPE, SIG_IGN);
  on_signal(SIGXFSZ, SIG_IGN);
}

int terminal_columns() {
  winsize size{};
  const bool known = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20;
  return known ? size.ws_col : 80;
}

}  // namespace fathom::cli
