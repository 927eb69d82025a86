// SPDX-License-Identifier: Apache-2.0
#include "python/stop.hpp"

#include "python/errors.hpp"

namespace fathom::python {

int Stop::ask() {
  const pybind11::gil_scoped_acquire lock;
  if (PyErr_CheckSignals() != 0) {
    error_.emplace();  // takes what was thrown
    ++count_;
  }
  return count_;
}

void Stop::rethrow() {
  if (!error_) return;
  const pybind11::error_already_set error = *error_;
  error_.reset();
  throw error;
}

void SignalWatch::look() {
  constexpr std::chrono::milliseconds kOften(50);
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < kOften) return;
  last_ = now;
  const pybind11::gil_scoped_acquire lock;
  check_signals();
}

StopRequests requests_of(const std::shared_ptr<Stop>& stop) {
  return [stop] { return stop->ask(); };
}

}  // namespace fathom::python
