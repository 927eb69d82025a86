// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/console.hpp"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <system_error>

#include "engine/error.hpp"
#include "engine/printable.hpp"

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

bool is_ignored(int signal_number) {
  struct sigaction action = {};
  return sigaction(signal_number, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

/// Stderr may be closed or full; what cannot be said there is not worth dying for.
void say(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

}  // namespace

void print_line(std::string_view line) {
  std::string lines;
  for (;;) {
    const std::size_t end = std::min(line.find('\n'), line.size());
    lines += printable(line.substr(0, end)) + "\n";
    if (end == line.size()) break;
    line.remove_prefix(end + 1);
  }
  print_lines(lines);
}

void print_line_on_the_way(std::string_view line) {
  try {
    print_line(line);
  } catch (const OutputError&) {  // stdout remembers
  }
}

void print_lines(std::string_view lines) {
  errno = 0;
  std::fwrite(lines.data(), 1, lines.size(), stdout);
  flush_lines();
}

void flush_lines() {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return;
  static const int first_problem = errno != 0 ? errno : EIO;  // what follows may say nothing
  throw OutputError(fmt::format("cannot write to standard output: {}",
                                std::generic_category().message(first_problem)));
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
  std::string line = printable(text());
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

namespace {

bool is_word(const char* variable) {
  const char* const value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

/// A terminal that knows no escape sequences calls itself dumb, or nothing.
bool is_smart_terminal() {
  return ::isatty(STDERR_FILENO) == 1 && is_word("TERM") &&
         std::string_view(std::getenv("TERM")) != "dumb";
}

ProgressBlock::Room room_of_terminal() {
  winsize size{};
  if (::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0)
    return {.columns = 79, .rows = 23};
  return {.columns = size.ws_col - 1, .rows = size.ws_row - 1};
}

}  // namespace

ProgressBlock::ProgressBlock() : is_live_(is_smart_terminal()) {}

ProgressBlock::~ProgressBlock() { clear(); }

void ProgressBlock::clear() {
  if (shown_ > 0) say(fmt::format("\033[{}A\r\033[J", shown_));
  shown_ = 0;
}

void ProgressBlock::show(const std::function<std::vector<std::string>(const Room&)>& lines) {
  if (!is_live_) return;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return;
  next_ = now + std::chrono::milliseconds(100);
  const std::vector<std::string> all = lines(room_of_terminal());
  std::string text = shown_ > 0 ? fmt::format("\033[{}A\r", shown_) : "";
  for (const std::string& line : all) text += line + "\033[K\n";
  say(text + "\033[J");
  shown_ = all.size();
}

bool may_colour() { return is_smart_terminal() && !is_word("NO_COLOR"); }

int stop_requests() { return interrupts; }

void catch_signals() {
  for (const int wish : {SIGINT, SIGTERM, SIGHUP}) {
    if (!is_ignored(wish)) on_signal(wish, on_interrupt);
  }
  // A closed pipe or a file-size limit must come back as an error of the write, not kill the
  // program before it has put the lens back and saved the run.
  on_signal(SIGPIPE, SIG_IGN);
  on_signal(SIGXFSZ, SIG_IGN);
}

void open_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    // The lowest number that is free is the one that is missing.
    if (::fcntl(stream, F_GETFD) < 0 && errno == EBADF) ::open("/dev/null", O_RDWR);
  }
}

int terminal_columns() {
  winsize size{};
  const bool known = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20;
  return known ? size.ws_col : 80;
}

}  // namespace fathom::cli
