// SPDX-License-Identifier: Apache-2.0
// An INDI rig on the fake server.
#pragma once

#include <fitsio.h>

#include <chrono>
#include <string>

#include "fake_server.hpp"
#include "hal/clock.hpp"
#include "hal/rig_driver.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom::test {

using namespace std::chrono_literals;

/// 64 x 48 pixels of 16 bit that all differ.
inline std::string ramp_picture(long width = 64, long height = 48, int type = USHORT_IMG) {
  std::vector<double> pixels;
  for (long i = 0; i < width * height; ++i) {
    pixels.push_back(type == BYTE_IMG ? static_cast<double>(i % 251)
                                      : 1000.0 + 13.0 * static_cast<double>(i));
  }
  return make_fits(type, {width, height}, pixels);
}

/// Opens the fake server's rig; more: "key=value,key=value".
inline Hardware open_rig(const FakeServer& server, const std::string& more = "",
                         OpenOptions options = {}) {
  const bool says_timeout = more.find("timeout_s=") != std::string::npos;
  return open_hardware("indi:server=" + server.address() + ",stall_s=0.5" +
                           (says_timeout ? "" : ",timeout_s=0.5") +
                           (more.empty() ? "" : "," + more),
                       options);
}

inline Hardware open_camera(const FakeServer& server, const std::string& more = "exposure_ms=20",
                            StopRequests stop = never_stop) {
  return open_rig(server, more, {.lens = false, .stop_requests = std::move(stop)});
}

inline Hardware open_lens(const FakeServer& server, const std::string& more = "",
                          StopRequests stop = never_stop) {
  return open_rig(server, more, {.camera = false, .stop_requests = std::move(stop)});
}

/// Expects that a call ends within a time, as everything that waits must.
template <class Call>
void expect_within(std::chrono::milliseconds limit, Call&& call) {
  const auto start = std::chrono::steady_clock::now();
  call();
  EXPECT_LT(std::chrono::steady_clock::now() - start, limit);
}

}  // namespace fathom::test
