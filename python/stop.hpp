// SPDX-License-Identifier: Apache-2.0
// Ctrl-C of Python, as the library's wish to stop.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>

#include "hal/stop.hpp"

namespace fathom::python {

/// Counts wishes to stop: those that Python's signals throw, and those of stop().
class Stop {
 public:
  /// A new run begins: nobody has asked yet. Drivers that watch the count look at its change.
  void begin() {
    count_ = 0;
    error_.reset();
  }
  /// Another thread, or a callback, wants the run to end.
  void request() { ++count_; }
  /// Looks for signals, with Python's lock, and tells the count.
  int ask();
  /// Throws what a signal threw, if one did.
  void rethrow();

 private:
  std::atomic<int> count_ = 0;
  std::optional<pybind11::error_already_set> error_;
};

/// Lets Python look for signals now and then, in work without its lock that may take minutes.
class SignalWatch {
 public:
  /// Needs no lock. Throws what a signal throws, such as KeyboardInterrupt.
  void look();

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// As the library takes it; the stop lives as long as anybody asks.
StopRequests requests_of(const std::shared_ptr<Stop>& stop);

}  // namespace fathom::python
