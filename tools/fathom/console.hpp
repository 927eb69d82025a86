// SPDX-License-Identifier: Apache-2.0
// What the program prints, and where: results on stdout, everything else on stderr.
#pragma once

#include <fmt/format.h>

#include <chrono>
#include <functional>
#include <string>
#include <string_view>

namespace fathom::cli {

/// One JSON object on one line; numbers with 17 significant digits, so that a double survives the
/// trip.
class JsonLine {
 public:
  JsonLine& add(std::string_view key, double value);
  JsonLine& add(std::string_view key, int value);
  JsonLine& add(std::string_view key, std::size_t value);
  JsonLine& add(std::string_view key, std::string_view value);
  JsonLine& add(std::string_view key, const char* value) {
    return add(key, std::string_view(value));
  }
  /// A value that there is none of, such as the distance of a run without focus.
  JsonLine& add_null(std::string_view key);
  std::string text() const { return "{" + body_ + "}"; }

 private:
  JsonLine& append(std::string_view key, std::string_view value);
  std::string body_;
};

/// Prints a line on stdout and flushes it, so that a reader at the other end of a pipe sees it now.
/// Throws Error(io) where stdout takes no more.
void print_line(std::string_view line);
/// For those who print many lines at once: flushes them. Throws as print_line does.
void flush_lines();

/// Says something on stderr, on a line of its own: "fathom: ...".
void note(std::string_view text);

/// A line on stderr that is rewritten in place; nothing at all where stderr is no terminal.
/// Cleared when it goes out of scope.
class Progress {
 public:
  Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();

  /// Shows text; at most some 20 times a second, so that progress costs nothing.
  void show(const std::function<std::string()>& text);
  /// "label ######---- 42 %"
  void bar(std::string_view label, std::size_t done, std::size_t total);

 private:
  bool live_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point next_;
};

/// Whether Ctrl-C was pressed; the first one only sets this, the second one ends the program.
bool stop_requested();
/// Makes Ctrl-C a request and a failed write an error.
void catch_signals();

/// Columns of the terminal, 80 where there is none.
int terminal_columns();

}  // namespace fathom::cli
