// SPDX-License-Identifier: Apache-2.0
// Rig texts and rig files, up to opened hardware.
#include "hal/rig_text.hpp"

#include <gtest/gtest.h>

#include "engine/file.hpp"
#include "pictures/picture.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fathom::test {
namespace {

std::string first_value(const RigPart& part, const char* key) {
  return part.settings.text(key, "-");
}

/// A folder with one-pixel-wide stacks in it: `names` of them, each of three frames.
class Rigs : public testing::Test {
 protected:
  std::string stack(const std::string& name, int side) {
    for (int i = 0; i < 3; ++i) {
      const std::size_t count = static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
      write_picture(folder_ / (name + "/" + std::to_string(i) + ".pgm"),
                    Frame(side, side, std::vector<std::uint8_t>(count, std::uint8_t(i))));
    }
    return (folder_ / name).string();
  }

  std::string rig_file(const std::string& toml) {
    write_file(folder_ / "rig.toml", toml);
    return (folder_ / "rig.toml").string();
  }

  TemporaryFolder folder_;
};

TEST(RigOptions, AreADriverAndItsKeys) {
  const RigPart part = parse_rig_options("sim:target=orange,distance=1500");
  EXPECT_STREQ(part.driver->name(), "sim");
  EXPECT_EQ(first_value(part, "target"), "orange");
  EXPECT_EQ(first_value(part, "distance"), "1500");
  EXPECT_TRUE(parse_rig_options("sim").settings.values().empty());
  EXPECT_TRUE(parse_rig_options("sim:").settings.values().empty());
}

TEST(RigOptions, ABareValueMayHoldCommasColonsAndEqualsSigns) {
  const RigPart part = parse_rig_options("replay:a,b=c:d.tif");
  EXPECT_EQ(first_value(part, "path"), "a,b=c:d.tif");
  EXPECT_EQ(first_value(parse_rig_options("replay:path=x"), "path"), "x");
}

TEST(RigOptions, KeysMayFollowABareValue) {
  const RigPart part = parse_rig_options("indi:box:7625,camera=CCD Simulator,gain=2");
  EXPECT_EQ(first_value(part, "server"), "box:7625");
  EXPECT_EQ(first_value(part, "camera"), "CCD Simulator");
  EXPECT_EQ(first_value(part, "gain"), "2");
  EXPECT_EQ(first_value(parse_rig_options("indi:camera=CCD,server=box"), "server"), "box");
  expect_error(ErrorCode::bad_argument, [] { parse_rig_options("indi:box,gain=2,server=other"); },
               {"server is given twice"});
  expect_error(ErrorCode::bad_argument, [] { parse_rig_options("indi:box,other"); },
               {"\"other\" is not key=value"});
}

TEST(RigOptions, MistakesAreNamed) {
  expect_error(ErrorCode::bad_argument, [] { parse_rig_options("smi:x=1"); },
               {"no rig driver \"smi\"", "sim", "replay", ".toml"});
  expect_error(ErrorCode::bad_argument, [] { parse_rig_options(""); });
  expect_error(ErrorCode::bad_argument, [] { parse_rig_options("sim:noise"); },
               {"\"noise\" is not key=value"});
  expect_error(ErrorCode::bad_argument, [] { parse_rig_options("sim:=1"); });
  expect_error(ErrorCode::bad_argument, [] { parse_rig_options("sim:a=1,a=2"); },
               {"a is given twice"});
}

TEST(RigFile, TakesTextsNumbersAndFlags) {
  const RigRequest request =
      parse_rig_file("driver = 'sim'\ntarget = 'usaf'\ndistance = 1500\nnoise = 0.25\nx = true\n",
                     "/rigs/my.toml");
  EXPECT_FALSE(request.lens);
  EXPECT_EQ(first_value(request.camera, "target"), "usaf");
  EXPECT_EQ(first_value(request.camera, "distance"), "1500");
  EXPECT_EQ(first_value(request.camera, "noise"), "0.25");
  EXPECT_TRUE(request.camera.settings.flag("x", false));
}

TEST(RigFile, PathsAreRelativeToIt) {
  const auto path_of = [](const char* toml) {
    return first_value(parse_rig_file(toml, "/rigs/my.toml").camera, "path");
  };
  EXPECT_EQ(path_of("driver = 'replay'\npath = 'stack'"), "/rigs/stack");
  EXPECT_EQ(path_of("driver = 'replay'\npath = '/data/stack'"), "/data/stack");
}

TEST(RigFile, MistakesAreNamed) {
  const auto parse = [](const char* toml) { return [=] { parse_rig_file(toml, "my.toml"); }; };
  expect_error(ErrorCode::bad_data, parse("driver = 'sim'\nx ="), {"my.toml line 2"});
  expect_error(ErrorCode::bad_data, parse("target = 'usaf'"), {"my.toml", "needs driver"});
  expect_error(ErrorCode::bad_data, parse(""), {"needs driver"});
  expect_error(ErrorCode::bad_data, parse("driver = 3"), {"needs driver"});
  expect_error(ErrorCode::bad_argument, parse("driver = 'smi'"), {"no rig driver \"smi\""});
  expect_error(ErrorCode::bad_data, parse("driver = 'sim'\nx = [1]"), {"x must be a text"});
  expect_error(ErrorCode::bad_data, parse("[camera]\ndriver = 'sim'"), {"needs both tables"});
  expect_error(ErrorCode::bad_data, parse("[lens]\ndriver = 'sim'"), {"needs both tables"});
  expect_error(ErrorCode::bad_data,
               parse("x = 1\n[camera]\ndriver = 'sim'\n[lens]\ndriver = 'sim'"),
               {"x stands outside"});
  expect_error(ErrorCode::bad_data, parse("[camera]\ndriver = 'sim'\n[lens]\n"),
               {"my.toml [lens]"});
}

TEST_F(Rigs, OpenFromAText) {
  const Hardware hardware = open_hardware("replay:" + stack("a", 8));
  EXPECT_EQ(hardware.lens->info().highest, 2);
  EXPECT_EQ(hardware.camera->settings().width_px, 8);
}

TEST_F(Rigs, OpenFromAFile) {
  stack("a", 8);
  const Hardware hardware = open_hardware(rig_file("driver = 'replay'\npath = 'a'\n"));
  EXPECT_EQ(hardware.camera->settings().width_px, 8);
}

TEST_F(Rigs, CameraAndLensMayComeFromTwoDrivers) {
  stack("a", 8);
  stack("b", 16);
  const Hardware hardware = open_hardware(
      rig_file("[camera]\ndriver = 'replay'\npath = 'a'\n[lens]\ndriver = 'replay'\npath = 'b'\n"));
  EXPECT_NE(hardware.camera->description().find("8 x 8 px"), std::string::npos);
  EXPECT_NE(hardware.lens->info().description.find("16 x 16 px"), std::string::npos);
  EXPECT_EQ(hardware.stage, nullptr);
  EXPECT_EQ(hardware.lens->move_to(2).position, 2);
}

TEST_F(Rigs, AMistypedKeyIsRefusedInTextAndFile) {
  const std::string a = stack("a", 8);
  expect_error(ErrorCode::bad_argument,
               [&] { open_hardware(rig_file("driver = 'replay'\npath = 'a'\npaht = 'b'")); },
               {"no key \"paht\"", "path"});
  expect_error(ErrorCode::bad_argument,
               [&] {
                 open_hardware(
                     rig_file("[camera]\ndriver = 'replay'\npath = 'a'\n"
                              "[lens]\ndriver = 'replay'\npath = 'a'\nspeed = 3"));
               },
               {"[lens]", "no key \"speed\""});
}

TEST_F(Rigs, TellWhatIsSaidOfTheirLens) {
  EXPECT_TRUE(lens_has_key("indi:box,backlash=5", "backlash"));
  EXPECT_FALSE(lens_has_key("indi:box", "backlash"));
  const std::string both =
      rig_file("[camera]\ndriver = 'sim'\nbacklash = 3\n[lens]\ndriver = 'sim'\ntarget = 'usaf'\n");
  EXPECT_FALSE(lens_has_key(both, "backlash"));
}

TEST_F(Rigs, AFileThatIsNotThereIsNamed) {
  expect_error(ErrorCode::io, [&] { open_hardware((folder_ / "none.toml").string()); },
               {"none.toml", "No such file"});
  expect_error(ErrorCode::io, [&] { open_hardware("replay:" + (folder_ / "none").string()); },
               {"none", "No such file"});
  expect_error(ErrorCode::bad_argument, [] { open_hardware("replay"); }, {"which pictures"});
  expect_error(ErrorCode::bad_argument, [] { open_hardware("replay:"); }, {"which pictures"});
}

}  // namespace
}  // namespace fathom::test
