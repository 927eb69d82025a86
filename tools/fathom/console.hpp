// SPDX-License-Identifier: Apache-2.0
// What the program prints, and where: results on stdout, everything else on stderr.
#pragma once

#include <fmt/format.h>

#include <chrono>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace fathom::cli {

/// Appends a JSON number of 17 significant digits, so that a double survives the trip; null for
/// what JSON has no number for.
void append_json(std::string& text, double value);
void append_json(std::string& text, int value);
void append_json(std::string& text, std::size_t value);

/// One JSON object on one line.
class JsonLine {
 public:
  template <typename Number>
  requires std::is_arithmetic_v<Number> JsonLine& add(std::string_view key, Number value) {
    append_key(key);
    append_json(body_, value);
    return *this;
  }
  JsonLine& add(std::string_view key, std::string_view value);
  JsonLine& add(std::string_view key, const char* value) {
    return add(key, std::string_view(value));
  }
  JsonLine& add(std::string_view key, std::span<const double> values);
  /// A value that there is none of, such as the distance of a run without focus.
  JsonLine& add_null(std::string_view key);
  /// Members that are JSON already: "key":value,...
  JsonLine& add_members(std::string_view members);
  /// A value that is JSON already.
  JsonLine& add_json(std::string_view key, std::string_view value);
  std::string text() const { return "{" + body_ + "}"; }
  /// The text without its braces, for those who put lines together from parts.
  const std::string& body() const { return body_; }

 private:
  void append_key(std::string_view key);
  std::string body_;
};

/// Prints a line on stdout and flushes it, so that a reader at the other end of a pipe sees it now.
/// Throws Error(io) where stdout takes no more.
void print_line(std::string_view line);
/// The same for many lines at once, each with its line end.
void print_lines(std::string_view lines);
/// For those who print by other means: flushes stdout. Throws as print_line does.
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
  /// Takes the line away before something is printed on stdout, which may be the same terminal.
  void clear();

 private:
  bool live_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point next_;
};

/// How often Ctrl-C was pressed. The first one ends the measurement, the second one the lens's way
/// back; the third one kills the program.
int stop_requests();
inline bool stop_requested() { return stop_requests() > 0; }
/// Makes Ctrl-C a request and a failed write an error.
void catch_signals();

/// Columns of the terminal, 80 where there is none.
int terminal_columns();

}  // namespace fathom::cli
