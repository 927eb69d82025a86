// SPDX-License-Identifier: Apache-2.0
// Automatics are off while a camera or a lens is open, and come back as they were.
#include <gtest/gtest.h>

#include "hal/drivers/v4l2/controls.hpp"
#include "support.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom::test {
namespace {

using namespace std::chrono_literals;

class V4l2Controls : public testing::Test {
 protected:
  std::map<std::uint32_t, std::int32_t> values() const {
    std::map<std::uint32_t, std::int32_t> values;
    for (const auto& [id, control] : node_.controls) values[id] = control.value;
    return values;
  }
  std::int32_t value(std::uint32_t id) const { return node_.controls.at(id).value; }

  void refuse_all_controls(int refusal) {
    for (auto& entry : node_.controls) entry.second.refusal = refusal;
  }

  FakeSystem system_;
  FakeNode& node_ = add_webcam(system_);
};

TEST_F(V4l2Controls, AllAutomaticsAreOffWhileOpenAndComeBack) {
  const auto before = values();
  {
    const Hardware rig = open_v4l2(system_, {{"exposure_ms", "10"}, {"gain", "5"}});
    EXPECT_EQ(value(V4L2_CID_EXPOSURE_AUTO), V4L2_EXPOSURE_MANUAL);
    EXPECT_EQ(value(V4L2_CID_EXPOSURE_AUTO_PRIORITY), 0);
    EXPECT_EQ(value(V4L2_CID_AUTOGAIN), 0);
    EXPECT_EQ(value(V4L2_CID_AUTO_WHITE_BALANCE), 0);
    EXPECT_EQ(value(V4L2_CID_FOCUS_AUTO), 0);
    EXPECT_EQ(value(V4L2_CID_EXPOSURE_ABSOLUTE), 100);
  }
  EXPECT_EQ(values(), before);
}

TEST_F(V4l2Controls, AutomaticsOfSensorBoardsAreOffAsWell) {
  const std::pair<std::uint32_t, const char*> kinds[] = {
      {V4L2_CID_AUTO_N_PRESET_WHITE_BALANCE, "White Balance, Auto & Preset"},
      {V4L2_CID_WIDE_DYNAMIC_RANGE, "Wide Dynamic Range"},
      {V4L2_CID_IMAGE_STABILIZATION, "Image Stabilization"}};
  for (const auto& [id, name] : kinds) node_.controls[id] = {name, 0, 1, 1, 1};
  const auto before = values();
  {
    const Hardware rig = open_v4l2(system_);
    for (const auto& [id, name] : kinds) EXPECT_EQ(value(id), 0) << name;
  }
  EXPECT_EQ(values(), before);
}

/// The fake, as UVC cameras do, refuses a manual exposure while the automatic is on.
TEST_F(V4l2Controls, WhatWasFoundComesBackInTheOppositeOrder) {
  { const Hardware rig = open_v4l2(system_, {{"exposure_ms", "10"}}); }
  const auto& written = node_.written;
  const auto last = [&](std::uint32_t id) {
    for (std::size_t i = written.size(); i-- > 0;) {
      if (written[i].first == id) return i;
    }
    ADD_FAILURE() << "never written";
    return written.size();
  };
  EXPECT_LT(last(V4L2_CID_EXPOSURE_ABSOLUTE), last(V4L2_CID_EXPOSURE_AUTO));
  EXPECT_LT(last(V4L2_CID_EXPOSURE_AUTO), last(V4L2_CID_EXPOSURE_AUTO_PRIORITY));
}

TEST_F(V4l2Controls, WhatIsOffAlreadyIsNotWritten) {
  for (auto& [id, control] : node_.controls) {
    if (control.highest == 1) control.value = 0;
  }
  node_.controls[V4L2_CID_EXPOSURE_AUTO].value = V4L2_EXPOSURE_MANUAL;
  { const Hardware rig = open_v4l2(system_); }
  EXPECT_TRUE(node_.written.empty());
}

TEST_F(V4l2Controls, TheValueFoundFirstComesBackAfterManyChanges) {
  {
    const Hardware rig = open_v4l2(system_);
    for (const double exposure_ms : {10.0, 20.0, 30.0}) {
      CameraSettings settings = rig.camera->settings();
      settings.exposure_ms = exposure_ms;
      rig.camera->apply(settings);
    }
    EXPECT_EQ(value(V4L2_CID_EXPOSURE_ABSOLUTE), 300);
  }
  EXPECT_EQ(value(V4L2_CID_EXPOSURE_ABSOLUTE), 250);
}

TEST_F(V4l2Controls, TheyComeBackWhenOpeningFails) {
  const auto before = values();
  for (const unsigned long request : {VIDIOC_STREAMON, VIDIOC_REQBUFS, VIDIOC_QUERYBUF}) {
    node_.refusals = {{request, EIO}};
    expect_error(ErrorCode::io, [&] { open_v4l2(system_, {{"exposure_ms", "10"}}); });
    EXPECT_EQ(values(), before);
  }
  node_.refusals.clear();
  expect_error(ErrorCode::unsupported, [&] {
    open_v4l2(system_, {{"exposure_ms", "10"}, {"gain", "3"}});
  });
  EXPECT_EQ(values(), before);
}

TEST_F(V4l2Controls, TheyComeBackWhenAMeasurementThrows) {
  const auto before = values();
  try {
    const Hardware rig = open_v4l2(system_, {{"exposure_ms", "10"}});
    rig.lens->move_to(1e9);
  } catch (const Error&) {
  }
  EXPECT_EQ(values(), before);
}

TEST_F(V4l2Controls, AnUnpluggedDeviceIsClosedWithoutAWord) {
  Hardware rig = open_v4l2(system_, {{"exposure_ms", "10"}});
  node_.is_unplugged = true;
  EXPECT_NO_THROW(rig = Hardware());
  EXPECT_EQ(node_.open_count, 0);
}

/// So a camera does whose lens is moving, or whose bus is disturbed, just when it is closed.
TEST_F(V4l2Controls, WhatIsRefusedForAMomentComesBackAllTheSame) {
  const auto before = values();
  for (const int refusal : {EPIPE, EIO, ETIMEDOUT, EBUSY}) {
    {
      const Hardware rig = open_v4l2(system_, {{"exposure_ms", "10"}});
      refuse_all_controls(refusal);
      system_.on_sleep = [&, until_ns = system_.now_ns() + 700 * kMs] {
        if (system_.now_ns() >= until_ns) refuse_all_controls(0);
      };
    }
    EXPECT_EQ(values(), before) << refusal;
    system_.on_sleep = nullptr;
  }
}

/// A control request that is not answered lasts five seconds in uvcvideo.
TEST_F(V4l2Controls, OneRefusalHoweverSlowIsTriedAgain) {
  FakeControl& automatic = node_.controls[V4L2_CID_FOCUS_AUTO];
  {
    const Hardware rig = open_v4l2(system_);
    automatic.refusal = ETIMEDOUT;
    node_.on_write_refused = [&] {
      system_.sleep_until_ns(system_.now_ns() + 5000 * kMs);
      automatic.refusal = 0;
    };
  }
  EXPECT_EQ(automatic.value, 1);
}

TEST_F(V4l2Controls, WhatIsRefusedForGoodHoldsUpNobody) {
  for (const int refusal : {EPIPE, EINVAL}) {
    Hardware rig = open_v4l2(system_);
    refuse_all_controls(refusal);
    const std::int64_t before_ns = system_.now_ns();
    EXPECT_NO_THROW(rig = Hardware());
    EXPECT_LE(system_.now_ns(), before_ns + (refusal == EINVAL ? 0 : 2200 * kMs))
        << "a second each for the camera's and the lens's";
    EXPECT_EQ(node_.open_count, 0);
    refuse_all_controls(0);
  }
}

TEST_F(V4l2Controls, AFormatThatIsRefusedForAMomentComesBack) {
  const v4l2_pix_format before = node_.format;
  {
    const Hardware rig = open_v4l2(system_, {{"format", "Y16"}, {"width", "16"}});
    ASSERT_NE(node_.format.pixelformat, before.pixelformat);
    node_.refusals = {{VIDIOC_S_FMT, EBUSY}, {VIDIOC_S_PARM, EIO}};
    system_.on_sleep = [&] { node_.refusals.clear(); };
  }
  system_.on_sleep = nullptr;
  EXPECT_EQ(node_.format.pixelformat, before.pixelformat);
  EXPECT_EQ(node_.format.width, before.width);
}

TEST_F(V4l2Controls, AnAutomaticThatStaysOnIsNamed) {
  node_.controls[V4L2_CID_AUTO_WHITE_BALANCE].becomes = [](std::int32_t) { return 1; };
  const auto before = values();
  expect_error(ErrorCode::io, [&] { open_v4l2(system_); },
               {"White Balance, Automatic", "automatics=leave"});
  EXPECT_EQ(values(), before);
  node_.controls[V4L2_CID_AUTO_WHITE_BALANCE].refusal = EPIPE;
  expect_error(ErrorCode::io, [&] { open_v4l2(system_); }, {"White Balance, Automatic"});
  EXPECT_EQ(values(), before);
}

/// automatics=leave is no way out: it would move the lens while it is measured.
TEST_F(V4l2Controls, AnAutofocusThatStaysOnIsAnErrorWithAWayOutOfItsOwn) {
  node_.controls[V4L2_CID_FOCUS_AUTO].becomes = [](std::int32_t) { return 1; };
  for (const auto& keys : {std::map<std::string, std::string>{}, {{"automatics", "leave"}}}) {
    try {
      open_v4l2(system_, keys);
      ADD_FAILURE() << "opened";
    } catch (const Error& error) {
      const std::string text = error.what();
      EXPECT_EQ(error.code(), ErrorCode::io);
      EXPECT_NE(text.find("Focus, Automatic Continuous"), std::string::npos) << text;
      EXPECT_NE(text.find("another camera"), std::string::npos) << text;
      EXPECT_EQ(text.find("automatics=leave"), std::string::npos) << text;
    }
  }
}

TEST_F(V4l2Controls, WhatCannotBeSetOrHasNoEffectIsLeft) {
  node_.controls[V4L2_CID_AUTO_WHITE_BALANCE].flags = V4L2_CTRL_FLAG_READ_ONLY;
  node_.controls[V4L2_CID_AUTOGAIN].flags = V4L2_CTRL_FLAG_INACTIVE;
  const Hardware rig = open_v4l2(system_);
  EXPECT_EQ(value(V4L2_CID_AUTO_WHITE_BALANCE), 1);
  EXPECT_EQ(value(V4L2_CID_AUTOGAIN), 1);
}

TEST_F(V4l2Controls, AnExposureWithoutManualTakesShutterPriority) {
  FakeControl& control = node_.controls[V4L2_CID_EXPOSURE_AUTO];
  control.becomes = [&](std::int32_t value) {
    return value == V4L2_EXPOSURE_MANUAL ? control.value : value;
  };
  const Hardware rig = open_v4l2(system_, {}, {.camera = true, .lens = false});
  EXPECT_EQ(value(V4L2_CID_EXPOSURE_AUTO), V4L2_EXPOSURE_SHUTTER_PRIORITY);
}

TEST_F(V4l2Controls, ALensAloneSwitchesOffFocusAndNothingElse) {
  {
    const Hardware rig = open_v4l2(system_, {}, {.camera = false, .lens = true});
    EXPECT_EQ(rig.camera, nullptr);
    EXPECT_EQ(value(V4L2_CID_FOCUS_AUTO), 0);
    EXPECT_EQ(value(V4L2_CID_EXPOSURE_AUTO), V4L2_EXPOSURE_APERTURE_PRIORITY);
    EXPECT_FALSE(node_.is_streaming);
  }
  EXPECT_EQ(value(V4L2_CID_FOCUS_AUTO), 1);
}

TEST_F(V4l2Controls, ALensThatWasFocusingByItselfComesToRestBeforeTheFirstFrame) {
  for (const bool was_on : {true, false}) {
    node_.controls[V4L2_CID_FOCUS_AUTO].value = was_on ? 1 : 0;
    const std::int64_t opened_ns = system_.now_ns();
    const Hardware rig = open_v4l2(system_, {{"format", "GREY"}});
    EXPECT_EQ(system_.now_ns() - opened_ns, was_on ? 500 * kMs : 0);
    const auto frame = rig.camera->grab(1s);
    ASSERT_TRUE(frame);
    EXPECT_GE(frame->exposure.end_ns, opened_ns + (was_on ? 500 * kMs : 0));
  }
}

TEST_F(V4l2Controls, FocusComesBackWithTheLastOfCameraAndLens) {
  for (const bool is_camera_first : {true, false}) {
    Hardware rig;
    rig.camera = open_v4l2(system_, {}, {.camera = true, .lens = false}).camera;
    rig.lens = open_v4l2(system_, {}, {.camera = false, .lens = true}).lens;
    EXPECT_EQ(node_.open_count, 1) << "they share the node";
    if (is_camera_first) {
      rig.camera = nullptr;
      EXPECT_EQ(value(V4L2_CID_EXPOSURE_AUTO), V4L2_EXPOSURE_APERTURE_PRIORITY);
      rig.lens->move_to(200);
    } else {
      rig.lens = nullptr;
      EXPECT_TRUE(rig.camera->grab(1s));
    }
    EXPECT_EQ(value(V4L2_CID_FOCUS_AUTO), 0);
    rig = Hardware();
    EXPECT_EQ(value(V4L2_CID_FOCUS_AUTO), 1);
    EXPECT_EQ(node_.open_count, 0);
  }
}

TEST_F(V4l2Controls, NearestIsOnTheGridAndTheLowerOfTwo) {
  v4l2::Control control;
  control.lowest = -3;
  control.highest = 20;
  control.step = 5;
  EXPECT_EQ(control.nearest(-100), -3);
  EXPECT_EQ(control.nearest(1e300), 17);
  EXPECT_EQ(control.nearest(4.5), 2);
  EXPECT_EQ(control.nearest(4.6), 7);
  EXPECT_EQ(control.nearest(20), 17);
}

}  // namespace
}  // namespace fathom::test
