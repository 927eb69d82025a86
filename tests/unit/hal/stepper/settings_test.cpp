// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/stepper/settings.hpp"

#include <gtest/gtest.h>

#include <regex>

#include "engine/file.hpp"
#include "hal/rig_text.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fathom::test {
namespace {

using stepper::HomeBy;
using stepper::Settings;

using Keys = std::map<std::string, std::string>;

Settings read(Keys keys) {
  keys.emplace("port", "/dev/parport0");
  const RigSettings settings("rig", keys);
  const Settings read = Settings::read(settings);
  settings.require_all_used();
  return read;
}

TEST(StepperSettings, AreTheThesisMotorsWhereNothingIsSaid) {
  const Settings settings = read({});
  EXPECT_FALSE(settings.is_gpio);
  EXPECT_EQ(settings.parallel.step_bit, 0);
  EXPECT_EQ(settings.parallel.direction_bit, 1);
  EXPECT_EQ(settings.pace.rate(), 25);
  EXPECT_EQ(settings.lowest, 0);
  EXPECT_EQ(settings.highest, 1200);
  EXPECT_TRUE(settings.pulse.up_level) << "D1 high is out";
  EXPECT_EQ(settings.homing.by, HomeBy::nobody);
}

TEST(StepperSettings, AreReadForGpio) {
  const Settings settings = read({{"port", "gpio"},
                                  {"chip", "pinctrl-bcm2711"},
                                  {"step", "GPIO17"},
                                  {"dir", "27"},
                                  {"home", "22"},
                                  {"home_pull", "none"},
                                  {"out", "low"},
                                  {"step_on", "fall"},
                                  {"pulse_us", "2.5"},
                                  {"setup_us", "5"},
                                  {"hold_us", "6"},
                                  {"rate", "800"},
                                  {"limit", "1500"},
                                  {"accel", "4000"},
                                  {"start_rate", "100"},
                                  {"backlash", "11.5"},
                                  {"lowest", "20"},
                                  {"home_position", "0"},
                                  {"home_rate", "200"}});
  EXPECT_TRUE(settings.is_gpio);
  EXPECT_EQ(settings.gpio.chip, "pinctrl-bcm2711");
  EXPECT_EQ(settings.gpio.step, "GPIO17");
  EXPECT_EQ(settings.gpio.direction, "27");
  EXPECT_EQ(settings.gpio.home, "22");
  EXPECT_EQ(settings.pulse.rest, stepper::StepRest(true));
  EXPECT_FALSE(settings.pulse.up_level);
  EXPECT_EQ(settings.pulse.width_ns, 2500);
  EXPECT_EQ(settings.pulse.setup_ns, 5000);
  EXPECT_EQ(settings.pulse.hold_ns, 6000);
  EXPECT_EQ(settings.backlash_steps(), 12) << "rounded up: too much does no harm";
  EXPECT_EQ(settings.homing.pace.rate(), 200);
}

TEST(StepperSettings, ASwitchIsForHoming) {
  EXPECT_EQ(read({{"home", "paper"}}).homing.by, HomeBy::by_switch);
  EXPECT_EQ(read({{"home", "paper"}, {"home_by", "stop"}}).homing.by, HomeBy::stop);
  expect_error(ErrorCode::bad_argument, [] { read({{"home_by", "switch"}}); }, {"needs home"});
  expect_error(ErrorCode::bad_argument, [] { read({{"home", "pin10"}}); }, {"ack, busy, paper"});
}

TEST(StepperSettings, ARateAboveTheLimitIsRefused) {
  EXPECT_EQ(read({{"rate", "40"}}).pace.rate(), 40);
  expect_error(ErrorCode::unsupported,
               [] {
                 read({{"rate", "40.5"}});
               },
               {"rate=40.5", "limit=40", "nearest is rate=40"});
  EXPECT_EQ(read({{"rate", "2000"}, {"limit", "3000"}}).pace.rate(), 2000);
  EXPECT_EQ(read({{"limit", "10"}}).pace.rate(), 10) << "the usual rate gives way to the limit";
  expect_error(ErrorCode::bad_argument, [] { read({{"home_rate", "26"}}); }, {"home_rate=26"});
}

TEST(StepperSettings, PulsesMustFitIntoTheRate) {
  const Keys fast{{"rate", "5000"}, {"limit", "5000"}, {"pulse_us", "101"}};
  expect_error(ErrorCode::unsupported, [&] { read(fast); }, {"pulse_us=101", "pulse_us=100"});
  Keys toggling = fast;
  toggling["step_on"] = "toggle";
  EXPECT_NO_THROW(read(toggling)) << "one level per step";
}

TEST(StepperSettings, ARampNeedsAnAcceleration) {
  expect_error(ErrorCode::bad_argument, [] { read({{"start_rate", "5"}}); }, {"accel"});
  expect_error(ErrorCode::bad_argument, [] { read({{"start_rate", "30"}, {"accel", "5"}}); });
}

TEST(StepperSettings, ThatContradictThemselvesAreRefused) {
  const auto refused = [](const Keys& keys) {
    expect_error(ErrorCode::bad_argument, [&] { read(keys); });
  };
  refused({{"lowest", "10"}, {"highest", "10"}});
  refused({{"step_bit", "1"}});
  refused({{"step_bit", "8"}});
  refused({{"rate", "0"}});
  refused({{"rate", "-25"}});
  refused({{"accel", "-1"}});
  refused({{"pulse_us", "-1"}});
  refused({{"backlash", "1300"}});
  refused({{"home_position", "1"}});
  refused({{"home_margin", "0"}});
  refused({{"step_on", "rising"}});
  refused({{"out", "up"}});
  refused({{"step", "3"}});  // a key of GPIO
  refused({{"port", "gpio"}, {"step", "3"}});
  refused({{"port", "gpio"}, {"dir", "3"}});
  refused({{"port", "gpio"}, {"step", "3"}, {"dir", "4"}, {"step_bit", "0"}});
  refused({{"port", ""}});
}

TEST(StepperSettings, ASwitchNeedsRoomBelowTheLowestPositionForTheApproach) {
  expect_error(ErrorCode::unsupported,
               [] {
                 read({{"home", "ack"}, {"backlash", "8"}});
               },
               {"nearest is lowest=8", "home_position=-8"});
  EXPECT_NO_THROW(read({{"home", "ack"}, {"backlash", "8"}, {"home_position", "-8"}}));
  EXPECT_NO_THROW(read({{"home_by", "stop"}, {"backlash", "8"}}));
}

TEST(StepperSettings, MotorsThatCountDifferentlyHaveDifferentNames) {
  const std::string name = read({}).identity("port");
  for (const Keys& keys : {Keys{{"lowest", "5"}, {"home_position", "0"}}, Keys{{"highest", "1000"}},
                           Keys{{"home_position", "-5"}}, Keys{{"out", "low"}},
                           Keys{{"step_on", "toggle"}}, Keys{{"step_on", "fall"}}}) {
    EXPECT_NE(read(keys).identity("port"), name) << keys.begin()->first;
  }
  EXPECT_NE(read({}).identity("another port"), name);
  EXPECT_EQ(read({{"rate", "10"}, {"backlash", "4"}, {"settle_ms", "5"}}).identity("port"), name);
}

class StepperExample : public testing::TestWithParam<const char*> {};

/// The lens of an example. Any camera does: this is not its test, and a build may be without it.
RigSettings example_lens(const std::string& name) {
  const std::filesystem::path path = std::filesystem::path(FATHOM_EXAMPLE_RIGS) / (name + ".toml");
  const std::string text =
      std::regex_replace(read_file(path), std::regex("driver = \"v4l2\""), "driver = \"sim\"");
  const RigRequest request = parse_rig_file(text, path);
  EXPECT_STREQ(request.lens.value().driver->name(), "stepper");
  return request.lens->settings;
}

TEST_P(StepperExample, HasOnlyKeysThatAreThere) {
  const RigSettings keys = example_lens(GetParam());
  EXPECT_NO_THROW(Settings::read(keys));
  EXPECT_NO_THROW(keys.require_all_used());
}

INSTANTIATE_TEST_SUITE_P(Rigs, StepperExample,
                         testing::Values("stepper-gpio", "stepper-parallel-port"));

TEST(StepperExamples, TheThesisRigIsTheThesisRig) {
  const Settings settings = Settings::read(example_lens("stepper-parallel-port"));
  EXPECT_FALSE(settings.is_gpio);
  EXPECT_EQ(settings.pace.rate(), 25);
  EXPECT_EQ(settings.highest, 1200);
  EXPECT_EQ(settings.parallel.step_bit, 0);
  EXPECT_EQ(settings.parallel.direction_bit, 1);
  EXPECT_TRUE(settings.pulse.up_level);
  EXPECT_EQ(settings.pulse.rest, stepper::StepRest(false));
}

TEST(StepperDriver, OpensNothingWhereOnlyACameraIsWanted) {
  OpenOptions options;
  options.camera = options.lens = false;
  EXPECT_EQ(open_hardware("stepper:/dev/no-such-port", options).lens, nullptr);
}

TEST(StepperDriver, SaysThatThePortIsNotThere) {
  OpenOptions options;
  options.camera = false;
  expect_error(ErrorCode::unavailable, [&] { open_hardware("stepper:/dev/no-such-port", options); },
               {"/dev/no-such-port"});
  expect_error(ErrorCode::unavailable, [&] { open_hardware("stepper:/dev/null", options); },
               {"/dev/null"});
  expect_error(ErrorCode::unavailable,
               [&] { open_hardware("stepper:port=gpio,chip=nonesuch,step=1,dir=2", options); },
               {"GPIO"});
  expect_error(ErrorCode::bad_argument, [&] { open_hardware("stepper", options); }, {"port"});
}

TEST(StepperDriver, LooksForHardwareWithoutHarm) {
  for (const RigDriver* driver : all_rig_drivers()) {
    if (std::string_view(driver->name()) != "stepper") continue;
    for (const FoundHardware& found : driver->find()) {
      EXPECT_TRUE(found.text.starts_with("stepper:"));
      EXPECT_FALSE(found.description.empty());
      EXPECT_TRUE(found.has_lens);
      EXPECT_FALSE(found.has_camera);
    }
  }
}

}  // namespace
}  // namespace fathom::test
