// SPDX-License-Identifier: Apache-2.0
// Every profile that comes with the program, against a device of its dialect; and what goes wrong.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <thread>

#include "hal/clock.hpp"
#include "hal/drivers/serial/profile.hpp"
#include "hal/drivers/serial/serial_lens.hpp"
#include "hal/drivers/serial/settings.hpp"
#include "hal/rig_text.hpp"
#include "simulated_stage.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fathom::test {
namespace {

using serial::SerialLens;
using serial::Settings;

struct Kind {
  const char* profile;
  double unit;      ///< What the device counts for each unit of the lens.
  const char* end;  ///< Of its answers.
  bool has_home;
};

constexpr Kind kKinds[] = {{"grbl", 1, "\n", true},     {"marlin", 1, "\n", true},
                           {"zaber", 1, "\n", true},    {"pi", 1, "\n", true},
                           {"asi", 10, "\n", false},    {"prior", 10, "\r", false},
                           {"moonlite", 1, "#", false}, {"sketch", 1, "\n", false}};

/// A device, and a lens of it that may be opened again.
class Bench {
 public:
  /// rate: of its motor, in the lens's unit a second.
  explicit Bench(const Kind& kind, double rate = 300)
      : kind_(kind), stage(make_stage(kind.profile, rate * kind.unit)) {}

  std::map<std::string, std::string> keys() const {
    return {{"port", stage->port()}, {"profile", kind_.profile},
            {"lowest", "0"},         {"highest", "120"},
            {"step", "1"},           {"settle_ms", "1"},
            {"stall_s", "1"},        {"state", (folder_ / "state.json").string()}};
  }

  std::unique_ptr<SerialLens> open(std::map<std::string, std::string> more = {},
                                   const StopRequests& stop = never_stop) const {
    for (const auto& [key, value] : keys()) more.emplace(key, value);
    if (!forgets()) more.erase("state");
    const RigSettings rig("rig.toml [lens]", more);
    Settings settings = Settings::read(rig);
    rig.require_all_used();
    settings.profile.wait_s = 0;  // a pseudo-terminal resets nobody
    settings.profile.timeout_s = 0.1;
    return std::make_unique<SerialLens>(settings, stop);
  }

  /// One that knows where it is.
  std::unique_ptr<SerialLens> open_ready(std::map<std::string, std::string> more = {},
                                         const StopRequests& stop = never_stop) const {
    auto lens = open(std::move(more), stop);
    if (forgets()) {
      lens->declare_at(0);
    } else if (kind_.has_home) {
      lens->home();
    }
    return lens;
  }

  bool forgets() const {
    const std::string name = kind_.profile;
    return name == "grbl" || name == "marlin" || name == "sketch";
  }
  double truth() const { return stage->motor().position() / kind_.unit; }

 private:
  Kind kind_;
  TemporaryFolder folder_;

 public:
  std::unique_ptr<SimulatedStage> stage;
};

class SerialKinds : public testing::TestWithParam<Kind> {};

TEST_P(SerialKinds, MovesAndSaysWhereItStands) {
  const Bench bench(GetParam());
  const auto lens = bench.open_ready();
  for (const double goal : {50.0, 20.0, 20.0, 119.0}) {
    const Arrival arrival = lens->move_to(goal);
    EXPECT_EQ(arrival.position, goal);
    EXPECT_NEAR(bench.truth(), goal, 1e-6);
    EXPECT_EQ(lens->position(), goal);
    EXPECT_LE(arrival.started_ns, arrival.stopped_ns);
    EXPECT_LE(arrival.stopped_ns, arrival.settled_ns);
  }
  expect_error(ErrorCode::out_of_bounds, [&] { lens->move_to(121); }, {"121"});
}

TEST_P(SerialKinds, TakesUpItsPlayFromBelow) {
  const Bench bench(GetParam());
  const auto lens = bench.open_ready({{"backlash", "5"}});
  lens->move_to(60);
  const std::int64_t start_ns = monotonic_now_ns();
  lens->move_to(40);
  double lowest = 1e9;
  for (std::int64_t t = start_ns; t < monotonic_now_ns(); t += 1'000'000) {
    lowest = std::min(lowest, bench.stage->motor().position_at(t) / GetParam().unit);
  }
  EXPECT_NEAR(lowest, 35, 0.5);  // seen once a millisecond
  EXPECT_NEAR(bench.truth(), 40, 1e-6);
}

TEST_P(SerialKinds, StopsOnTheWayAndStillKnows) {
  const Bench bench(GetParam(), 40);
  int requests = 0;
  std::int64_t stop_at_ns = INT64_MAX;
  const auto lens = bench.open_ready(
      {}, [&] { return requests + static_cast<int>(monotonic_now_ns() > stop_at_ns); });
  stop_at_ns = monotonic_now_ns() + 100'000'000;
  expect_error(ErrorCode::cancelled, [&] { lens->move_to(120); }, {"stopped on the way"});
  EXPECT_FALSE(bench.stage->motor().is_moving());
  EXPECT_LT(bench.truth(), 119);
  EXPECT_NEAR(lens->position(), bench.truth(), 0.51);
}

TEST_P(SerialKinds, BearsEchoesNoiseAndLostAnswers) {
  const Bench bench(GetParam());
  const auto lens = bench.open_ready();
  bench.stage->set_faults(
      {.echoes = true, .noise = std::string("\xff\x01~\xfe") + GetParam().end, .drops_every = 5});
  for (const double goal : {30.0, 10.0, 45.0}) {
    EXPECT_EQ(lens->move_to(goal).position, goal);
    EXPECT_NEAR(bench.truth(), goal, 1e-6);
  }
}

TEST_P(SerialKinds, SaysThatItsCableWasPulled) {
  const Bench bench(GetParam(), 40);
  const auto lens = bench.open_ready();
  const auto pull = [&] {
    sleep_until_ns(monotonic_now_ns() + 60'000'000);
    bench.stage->unplug();
  };
  std::thread puller(pull);
  expect_error(ErrorCode::device_lost, [&] { lens->move_to(120); }, {"unplugged"});
  puller.join();
}

TEST_P(SerialKinds, SaysThatNobodyAnswers) {
  const Bench bench(GetParam());
  bench.stage->set_faults({.drops_every = 1});
  expect_error(ErrorCode::timeout, [&] { bench.open_ready()->move_to(10); }, {"does not answer"});
}

INSTANTIATE_TEST_SUITE_P(Profiles, SerialKinds, testing::ValuesIn(kKinds),
                         [](const auto& kind) { return std::string(kind.param.profile); });

constexpr Kind kGrbl = kKinds[0], kMarlin = kKinds[1], kZaber = kKinds[2], kPi = kKinds[3];

TEST(SerialTrust, ADeviceThatForgetsStandsWhereItWasLeftOrNowhere) {
  const Bench bench(kGrbl);
  expect_error(ErrorCode::unavailable, [&] { bench.open()->position(); }, {"--at POSITION"});
  bench.open_ready()->move_to(70);
  bench.stage->motor().set(0);  // switched off and on: it counts from zero again
  const auto lens = bench.open();
  EXPECT_EQ(lens->position(), 70);
  EXPECT_EQ(lens->move_to(80).position, 80);
  EXPECT_NEAR(bench.stage->motor().position(), 10, 1e-6);
}

TEST(SerialTrust, AResetOnTheWayLosesThePlace) {
  const Bench bench(kGrbl, 40);
  const auto lens = bench.open_ready();
  const auto motion = lens->start(120);
  bench.stage->say("\r\nGrbl 1.1h ['$' for help]\r\n");
  expect_error(ErrorCode::device_lost, [&] { motion->wait(); }, {"reset"});
  expect_error(ErrorCode::unavailable, [&] { bench.open(); }, {"in use"});
}

TEST(SerialTrust, AnAlarmIsSaidAndHomeHelps) {
  const Bench bench(kGrbl);
  {
    const auto lens = bench.open_ready();
    expect_error(ErrorCode::device_lost, [&] { lens->move_to(66); }, {"home it"});
    expect_error(ErrorCode::unavailable, [&] { lens->position(); }, {"rigs home RIG"});
    expect_error(ErrorCode::unavailable, [&] { lens->declare_at(3); }, {"home"});
  }
  const auto lens = bench.open();
  expect_error(ErrorCode::unavailable, [&] { lens->move_to(3); }, {"not known"});
  EXPECT_EQ(lens->home().position, 0);
  EXPECT_EQ(lens->move_to(30).position, 30);
}

TEST(SerialTrust, OneWithoutAReferenceSaysSoUntilItHasFoundIt) {
  for (const Kind& kind : {kZaber, kPi}) {
    const Bench bench(kind);
    const auto lens = bench.open();
    expect_error(ErrorCode::unavailable, [&] { lens->move_to(30); }, {"rigs home RIG"});
    EXPECT_EQ(lens->home().position, 0);
    EXPECT_EQ(lens->move_to(30).position, 30);
    expect_error(ErrorCode::unsupported, [&] { lens->declare_at(30); }, {"by itself"});
  }
}

TEST(SerialTrust, ADeviceIsAskedHowFarItMayTravel) {
  const Bench bench(kZaber);
  auto keys = bench.keys();
  keys.erase("lowest"), keys.erase("highest"), keys.erase("state");
  Settings settings = Settings::read(RigSettings("rig.toml [lens]", keys));
  settings.profile.timeout_s = 0.3;
  EXPECT_EQ(SerialLens(settings, never_stop).info().highest, 500);
}

TEST(SerialTrust, ARefusalMovesNothing) {
  const Bench bench(kGrbl);
  const auto lens = bench.open_ready({{"highest", "900"}});
  lens->move_to(20);
  expect_error(ErrorCode::unsupported, [&] { lens->move_to(800); }, {"soft limits"});
  EXPECT_EQ(lens->position(), 20);
}

TEST(SerialTrust, OneThatSaysWhereItWasSentIsNotWatched) {
  const Bench bench(kMarlin);
  const auto lens = bench.open_ready();
  EXPECT_FALSE(lens->can_be_watched());
  expect_error(ErrorCode::unsupported, [&] { lens->start(10); }, {"on its way"});
}

TEST(SerialPort, MarlinAlsoComesWithASpeedThatHasNoName) {
  const Bench bench(kMarlin);
  const auto lens = bench.open_ready({{"baud", "250000"}});
  EXPECT_EQ(lens->move_to(30).position, 30);
}

TEST(SerialPort, SaysWhatIsInTheWay) {
  const Bench bench(kGrbl);
  const auto open = [&](const std::string& port) { return bench.open({{"port", port}}); };
  expect_error(ErrorCode::unavailable, [&] { open("/dev/no-such-port"); }, {"rigs list"});
  expect_error(ErrorCode::bad_argument, [&] { open("/dev/null"); }, {"no serial port"});
  const auto first = bench.open();
  expect_error(ErrorCode::unavailable, [&] { bench.open(); }, {"in use"});
}

TEST(SerialSettings, SayWhatIsMissingOrWrong) {
  const auto read = [](std::map<std::string, std::string> keys) {
    const RigSettings rig("rig.toml [lens]", std::move(keys));
    Settings::read(rig);
    rig.require_all_used();
  };
  using Keys = std::map<std::string, std::string>;
  const std::pair<Keys, const char*> cases[] = {
      {{}, "port is missing"},
      {{{"port", "x"}}, "profile is missing"},
      {{{"port", "x"}, {"profile", "grblx"}}, "there are grbl, marlin"},
      {{{"port", "x"}, {"profile", "grbl"}}, "lowest and highest are missing"},
      {{{"port", "x"}, {"profile", "grbl"}, {"lowest", "9"}, {"highest", "3"}}, "below"},
      {{{"port", "x"}, {"profile", "zaber"}, {"baud", "1234"}}, "baud"},
      {{{"port", "x"}, {"profile", "zaber"}, {"axis", "1\n/1 reset"}}, "control characters"},
      {{{"port", "x"}, {"profile", "zaber"}, {"state", "y"}}, "state"},
  };
  for (const auto& [keys, word] : cases) {
    expect_error(ErrorCode::bad_argument, [&] { read(keys); }, {word});
  }
}

TEST(SerialSettings, TheExampleIsRight) {
  const auto path = std::filesystem::path(FATHOM_EXAMPLE_RIGS) / "serial.toml";
  const RigRequest request = parse_rig(path.string());
  const Settings settings = Settings::read(request.lens->settings);
  EXPECT_NO_THROW(request.lens->settings.require_all_used());
  EXPECT_EQ(settings.profile.name, "GRBL 1.1");
  EXPECT_NE(settings.profile.move.send.find("F300"), std::string::npos);
}

TEST(SerialProfile, EveryOneThatComesWithTheProgramCanBeRead) {
  for (const serial::KnownProfile& known : serial::known_profiles()) {
    const std::string name(known.name);
    EXPECT_FALSE(serial::read_profile(known.text, name, {}).name.empty()) << name;
  }
}

TEST(SerialProfile, SaysWhatIsWrongWithOne) {
  const std::string basics = "name = 'x'\nmanual = 'y'\n";
  const std::string move = "[move]\nsend = 'M{steps}'\n";
  const std::string place = "[position]\nsend = '?'\nanswer = '(.*)'\n";
  const std::string state = "[state]\nsend = '?'\nanswer = '.'\nmoving = 'B'\n";
  const auto read = [](const std::string& text) {
    return serial::read_profile(text, "p.toml", {});
  };
  EXPECT_EQ(read(basics + move + place + state).move.text({1, 7}), "M7\n");
  const std::pair<std::string, const char*> cases[] = {
      {move + place + state, "name is missing"},
      {basics + place + state, "[move] is missing"},
      {basics + move + state, "[position] is missing"},
      {basics + move + place, "needs [state]"},
      {basics + move + place + "[state]\nsend='?'\nanswer='.'\n", "moving is missing"},
      {basics + "[move]\nsend = 'M{stps}'\n" + place + state, "neither a variable"},
      {basics + "[move]\nsend = 'M{steps:1000000000}'\n" + place + state, "send"},
      {basics + "[move]\nsend = 'M{steps'\n" + place + state, "send"},
      {basics + move + "[position]\nsend = '?'\nanswer = '('\n" + state, "no regular expression"},
      {basics + move + "[position]\nsend = '?'\n" + state, "needs answer"},
      {basics + move + place + state + "[known]\nsend = '?'\nanswer = '.'\n", "[known] needs good"},
      {basics + "colour = 'red'\n" + move + place + state, "there is no colour"},
      {basics + "scale = 'big'\n" + move + place + state, "scale must be a number"},
      {basics + "[[trouble]]\nmatch='x'\nmeans='bad'\nwords='y'\n" + move + place + state, "means"},
      {basics + "[move]\nsend_bytes = [1, 900]\n" + place + state, "no byte"},
      {"name = [", "p.toml line 1"},
  };
  for (const auto& [text, word] : cases) {
    expect_error(ErrorCode::bad_data, [&] { read(text); }, {word});
  }
}

}  // namespace
}  // namespace fathom::test
