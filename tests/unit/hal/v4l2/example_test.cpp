// SPDX-License-Identifier: Apache-2.0
// The example of a rig file, as it is and with every key that it only mentions.
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>

#include "engine/file.hpp"
#include "hal/rig_text.hpp"
#include "support.hpp"

namespace fathom::test {
namespace {

using namespace std::chrono_literals;

class V4l2Example : public testing::Test {
 protected:
  V4l2Example() {
    node_.formats.front().sizes = {{640, 480}, {32, 24}};
    system_.add("/dev/v4l-subdev0").is_subdevice = true;
    subdevice().controls = {{V4L2_CID_FOCUS_ABSOLUTE, {"Focus, Absolute", 0, 1023, 1, 10}}};
  }
  FakeNode& subdevice() { return system_.at("/dev/v4l-subdev0"); }

  Hardware open(const std::string& text) {
    const RigRequest request = parse_rig_file(text, kPath);
    EXPECT_FALSE(request.lens);
    EXPECT_STREQ(request.camera.driver->name(), "v4l2");
    values_ = request.camera.settings.values();
    Hardware rig = v4l2::open(system_, request.camera.settings, {});
    EXPECT_NO_THROW(request.camera.settings.require_all_used());
    return rig;
  }

  static constexpr const char* kPath = FATHOM_EXAMPLE_RIG;
  const std::string example_{read_file(kPath)};
  FakeSystem system_;
  FakeNode& node_ = add_webcam(system_);
  std::map<std::string, std::string> values_;
};

TEST_F(V4l2Example, OpensAsItIs) {
  const Hardware rig = open(example_);
  EXPECT_TRUE(rig.camera->grab(1s));
  EXPECT_EQ(rig.lens->move_to(200).position, 200);
}

TEST_F(V4l2Example, OpensWithEveryKeyThatItMentions) {
  // With automatics=leave an exposure can only be set where it is manual already.
  node_.controls[V4L2_CID_EXPOSURE_AUTO].value = V4L2_EXPOSURE_MANUAL;
  const Hardware rig = open(std::regex_replace(example_, std::regex("\n# ([a-z_]+ = )"), "\n$1"));
  const auto equal_signs =
      std::count(example_.begin(), example_.end(), '=') - 1;  // that of "driver"
  EXPECT_EQ(static_cast<std::ptrdiff_t>(values_.size()), equal_signs) << "one was overlooked";
  EXPECT_EQ(rig.camera->settings(), (CameraSettings{640, 480, Depth::bits8, 10}));
  EXPECT_TRUE(rig.camera->grab(1s));
  const LensInfo info = rig.lens->info();
  EXPECT_EQ(info.highest, 250);
  EXPECT_EQ(info.coarse_spacing, 35);
  EXPECT_EQ(rig.lens->move_to(200).position, 200);
  EXPECT_EQ(subdevice().controls[V4L2_CID_FOCUS_ABSOLUTE].value, 200);
}

}  // namespace
}  // namespace fathom::test
