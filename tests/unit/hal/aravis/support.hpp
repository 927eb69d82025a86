// SPDX-License-Identifier: Apache-2.0
// The fake camera, opened as a rig.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <string>

#include "fake_gige.hpp"
#include "hal/rig_driver.hpp"

namespace fathom::test {

using namespace std::chrono_literals;

/// A small picture comes soon, on a machine that does much else at the same time too.
inline std::string gige(const std::string& keys = "",
                        const std::string& size = ",width=64,height=48") {
  return std::string("aravis:") + FakeGige::kAddress + size + keys;
}

inline Hardware open_camera(const std::string& text, const StopRequests& stop = never_stop) {
  return open_hardware(text, {.camera = true, .lens = false, .stop_requests = stop});
}

/// The next frame; a failure and an empty one if none comes.
inline Frame next_frame(Camera& camera, std::chrono::milliseconds patience = 10s) {
  std::optional<Frame> frame = camera.grab(patience);
  EXPECT_TRUE(frame) << "no frame";
  return frame ? std::move(*frame) : Frame();
}

}  // namespace fathom::test
