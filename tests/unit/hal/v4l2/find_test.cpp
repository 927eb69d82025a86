// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/v4l2/find.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "support.hpp"

namespace fathom::test {
namespace {

TEST(V4l2Find, ListsCamerasAndLensesAndChangesNothing) {
  FakeSystem system;
  FakeNode& webcam = add_webcam(system);
  add_webcam(system, "/dev/video1").capabilities = V4L2_CAP_META_CAPTURE | V4L2_CAP_STREAMING;
  add_webcam(system, "/dev/video2").controls.erase(V4L2_CID_FOCUS_ABSOLUTE);
  FakeNode& subdevice = system.add("/dev/v4l-subdev0");
  subdevice.is_subdevice = true;
  subdevice.controls = {{V4L2_CID_FOCUS_ABSOLUTE, {"Focus, Absolute", 0, 1023, 1, 10}}};
  system.add("/dev/v4l-subdev1").is_subdevice = true;
  system.add("/dev/videology");
  system.links["/dev/v4l/by-id/usb-Fake-video-index0"] = "/dev/video0";

  const auto found = v4l2::find_hardware(system);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].text, "v4l2:/dev/v4l-subdev0");
  EXPECT_TRUE(found[0].has_lens && !found[0].has_camera);
  EXPECT_EQ(found[1].text, "v4l2:/dev/v4l/by-id/usb-Fake-video-index0");
  EXPECT_TRUE(found[1].has_lens && found[1].has_camera);
  EXPECT_EQ(found[1].description,
            "Fake camera (/dev/video0): Y16 32 x 24, 16 x 12; GREY 32 x 24; YUYV 64 x 48, 32 x 24; "
            "focus 0 to 252, step 5");
  EXPECT_EQ(found[1].problem, "");
  EXPECT_EQ(found[2].text, "v4l2:/dev/video2");
  EXPECT_FALSE(found[2].has_lens);
  EXPECT_NE(found[2].description.find("no focus"), std::string::npos);
  EXPECT_TRUE(webcam.written.empty());
  EXPECT_EQ(std::count(webcam.requests.begin(), webcam.requests.end(), VIDIOC_S_FMT), 0);
  EXPECT_EQ(webcam.open_count, 0);
}

TEST(V4l2Find, NamesFormatsOfTheSameSizesTogether) {
  FakeSystem system;
  const std::vector<std::pair<int, int>> sizes = {{64, 48}, {32, 24}};
  add_webcam(system).formats = {
      {V4L2_PIX_FMT_GREY, sizes}, {V4L2_PIX_FMT_YUYV, sizes}, {V4L2_PIX_FMT_MJPEG, {{640, 480}}}};
  EXPECT_EQ(v4l2::find_hardware(system)[0].description,
            "Fake camera (/dev/video0): GREY, YUYV 64 x 48, 32 x 24; MJPEG 640 x 480; "
            "focus 0 to 252, step 5");
}

TEST(V4l2Find, TellsWhyACameraCannotBeOpened) {
  FakeSystem system;
  add_webcam(system).open_error = EACCES;
  add_webcam(system, "/dev/video1").refusals = {{VIDIOC_REQBUFS, EBUSY}};
  const auto found = v4l2::find_hardware(system);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NE(found[0].problem.find("group video"), std::string::npos);
  EXPECT_NE(found[1].problem.find("in use"), std::string::npos);
}

TEST(V4l2Find, FindsNothingWhereThereIsNothing) {
  FakeSystem system;
  EXPECT_TRUE(v4l2::find_hardware(system).empty());
}

}  // namespace
}  // namespace fathom::test
