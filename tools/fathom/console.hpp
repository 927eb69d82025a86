// SPDX-License-Identifier: Apache-2.0
// What the program prints, and where: results on stdout, everything else on stderr.
#pragma once

#include <fmt/format.h>

#include <chrono>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/error.hpp"
#include "session/json_line.hpp"

namespace fathom::cli {

/// Standard output takes no more: its reader went away, or its disk is full. Whoever prints many
/// things stops at it.
class OutputError : public Error {
 public:
  explicit OutputError(std::string_view message) : Error(ErrorCode::io, message) {}
};

/// Prints a line on stdout, or several with line breaks between them, and flushes, so that a reader
/// at the other end of a pipe sees it now. Each line is made harmless (engine/printable.hpp); a
/// name in it that may have line breaks the caller passes through printable(). Throws OutputError.
void print_line(std::string_view line);
/// The same while something is measured: a measurement does not end for want of a reader. What is
/// printed next throws all the same.
void print_line_on_the_way(std::string_view line);
/// Prints many lines at once, each with its line end, as they are: what others wrote in them the
/// caller has made harmless.
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

/// Some lines on stderr that are redrawn in place; nothing at all where that is no terminal, or one
/// that cannot go up. Cleared when it goes out of scope.
class ProgressBlock {
 public:
  /// Columns and rows of the terminal that there are for it.
  struct Room {
    int columns = 0;
    int rows = 0;
  };

  ProgressBlock();
  ProgressBlock(const ProgressBlock&) = delete;
  ProgressBlock& operator=(const ProgressBlock&) = delete;
  ~ProgressBlock();

  /// Whether anything will be seen.
  bool is_live() const { return is_live_; }
  /// Shows lines that fit the room; at most some 10 times a second. They may hold colours, and are
  /// otherwise the caller's own text.
  void show(const std::function<std::vector<std::string>(const Room& room)>& lines);
  /// Takes the lines away before something else is printed.
  void clear();

 private:
  bool is_live_;
  std::size_t shown_ = 0;  ///< Lines.
  std::chrono::steady_clock::time_point next_;
};

/// Whether stderr is a terminal that shows colours, and nobody asked for none (NO_COLOR).
bool may_colour();

/// How often Ctrl-C was pressed. The first one ends the measurement, the second one the lens's way
/// back; the third one kills the program.
int stop_requests();
inline bool stop_requested() { return stop_requests() > 0; }
/// Makes Ctrl-C a request and a failed write an error. A signal that was ignored when the program
/// began, as by nohup, stays ignored.
void catch_signals();

/// Opens what is closed of the standard streams on the null device. Else the next file or socket
/// would get their number, and what is printed. To be called before anything is opened.
void open_standard_streams();

/// Columns of the terminal, 80 where there is none.
int terminal_columns();

}  // namespace fathom::cli
