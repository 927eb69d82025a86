// SPDX-License-Identifier: Apache-2.0
// The driver "stepper" on GPIO lines of the kernel, through libgpiod, with a motor behind them that
// knows the truth. Run by usb_devices with --motor-start 30 --motor-least -20 --motor-most 300
// --motor-rate 200 --direction-settle 1000 --motor-backlash 5 --log /tmp/stepper-edges.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "engine/error.hpp"
#include "hal/clock.hpp"
#include "hal/rig_driver.hpp"
#include "tests/hardware/usb/commands.hpp"
#include "tests/hardware/usb/launch.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fathom::test {
namespace {

std::string chip() { return std::getenv("FATHOM_GPIOCHIP"); }

std::string command(const std::string& line) {
  return usb::command(std::getenv("FATHOM_USB_SOCKET"), line);
}

/// One number of what the motor knows.
int truth(const std::string& name) {
  const std::string text = ' ' + command("status");
  const std::size_t at = text.find(' ' + name + '=');
  return at == std::string::npos ? -9999 : std::stoi(text.substr(at + name.size() + 2));
}

struct LoggedEdge {
  std::int64_t time_ns;
  std::string line;
  int level, motor, carriage;
};

/// The edges that reached the motor since `begin_ns`.
std::vector<LoggedEdge> edges_since(std::int64_t begin_ns) {
  std::ifstream log("/tmp/stepper-edges");
  std::vector<LoggedEdge> edges;
  for (LoggedEdge edge;
       log >> edge.time_ns >> edge.line >> edge.level >> edge.motor >> edge.carriage;) {
    if (edge.time_ns >= begin_ns) edges.push_back(edge);
  }
  return edges;
}

class Gpio : public testing::Test {
 protected:
  static constexpr const char* kKeys =
      ",step=0,dir=1,limit=200,rate=200,home_rate=200,highest=200,pulse_us=1000,setup_us=1000,hold_"
      "us=1000"
      ",settle_ms=0,home=2,home_position=-8,backlash=8,home_margin=60";

  static std::unique_ptr<Lens> open_text(const std::string& keys, StopRequests stop) {
    return open_hardware("stepper:port=gpio,chip=" + chip() + keys,
                         {.camera = false, .stop_requests = std::move(stop)})
        .lens;
  }
  std::unique_ptr<Lens> open(StopRequests stop = never_stop) {
    return open_text(kKeys + (",state=" + state()), std::move(stop));
  }
  std::string state() const { return (folder / "state.json").string(); }

  TemporaryFolder folder;
};

TEST_F(Gpio, HomesMovesAndHoldsItsTimes) {
  const auto lens = open();
  expect_error(ErrorCode::unavailable, [&] { lens->position(); }, {"fathom rigs home RIG"});
  EXPECT_EQ(lens->home().position, 0);
  EXPECT_EQ(truth("motor"), 8) << "eight steps above the switch at 0";
  const int lost = truth("lost");
  const std::int64_t begun_ns = monotonic_now_ns();
  EXPECT_EQ(lens->move_to(30).position, 30);
  EXPECT_EQ(truth("motor"), 38);
  EXPECT_EQ(lens->move_to(20).position, 20);
  EXPECT_EQ(truth("motor"), 28);
  EXPECT_EQ(truth("carriage"), 28) << "it came from below";
  EXPECT_EQ(truth("lost"), lost);
  const std::vector<LoggedEdge> edges = edges_since(begun_ns);
  std::int64_t rose_ns = 0, turned_ns = 0;
  int steps = 0, turns = 0;
  for (const LoggedEdge& edge : edges) {
    if (edge.line == "DIR") {
      ++turns;
      turned_ns = edge.time_ns;
      EXPECT_GE(edge.time_ns - rose_ns, 1'000'000);
    } else if (edge.level == 0) {
      EXPECT_GE(edge.time_ns - rose_ns, 1'000'000);
    } else {
      ++steps;
      EXPECT_GE(edge.time_ns - turned_ns, 1'000'000);
      EXPECT_GE(edge.time_ns - rose_ns, 5'000'000) << "however slow the cable: no tolerance";
      rose_ns = edge.time_ns;
    }
  }
  EXPECT_EQ(steps, 30 + 18 + 8);
  EXPECT_EQ(turns, 2);
}

TEST_F(Gpio, TellsLostSteps) {
  const auto lens = open();
  lens->home();
  ASSERT_EQ(command("bridge lose 12"), "ok");
  EXPECT_EQ(lens->move_to(30).position, 30);
  EXPECT_EQ(truth("motor"), 26) << "12 short of 38";
  const Arrival arrival = lens->home();
  EXPECT_NE(arrival.note.find("12 steps early: steps were lost"), std::string::npos)
      << arrival.note;
  EXPECT_EQ(truth("motor"), 8);
}

TEST_F(Gpio, AWishToStopStopsTheMotorWhereItSays) {
  int to_ask = 0;  // this many times, and then the user wishes to stop
  const auto stop = [&to_ask] { return to_ask > 0 && --to_ask == 0 ? 1 : 0; };
  {
    const auto lens = open(stop);
    lens->home();
    to_ask = 40;
    expect_error(ErrorCode::cancelled, [&] { lens->move_to(200); }, {"from 0 to 200"});
    EXPECT_GT(lens->position(), 5);
    EXPECT_LT(lens->position(), 50);
    EXPECT_EQ(truth("motor"), lens->position() + 8);
  }
  EXPECT_EQ(truth("motor"), open()->position() + 8) << "the next run knows";
}

TEST_F(Gpio, AKilledProgramLeavesAnUnknownPosition) {
  {
    const auto lens = open();
    lens->home();
  }
  const pid_t child = ::fork();
  if (child == 0) {
    try {
      open()->move_to(200);
    } catch (...) {
    }
    ::_exit(1);
  }
  for (int i = 0; i < 200 && truth("motor") < 12; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  ::kill(child, SIGKILL);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_GT(truth("motor"), 8) << "it was on its way";
  const auto lens = open();  // neither the lock nor the lines are held any longer
  expect_error(ErrorCode::unavailable, [&] { lens->move_to(10); }, {"cut off while moving"});
  EXPECT_EQ(lens->home().position, 0);
  EXPECT_EQ(truth("motor"), 8);
}

TEST_F(Gpio, LinesOfSomebodyElseAreRefused) {
  const auto lens = open();
  const std::string other = ",state=" + (folder / "other.json").string();
  expect_error(ErrorCode::unavailable, [&] { open_text(",step=0,dir=3" + other, never_stop); },
               {"line 0", "in use by fathom"});
  expect_error(ErrorCode::bad_argument, [&] { open_text(",step=3,dir=3" + other, never_stop); },
               {"named twice"});
  expect_error(ErrorCode::bad_argument, [&] { open_text(",step=4,dir=3" + other, never_stop); },
               {"no line 4", "0 to 3"});
  expect_error(ErrorCode::bad_argument, [&] { open_text(",step=STEP,dir=3" + other, never_stop); },
               {"no line STEP"});
}

TEST_F(Gpio, ALevelThatIsNotTakenIsSeen) {
  const auto lens = open();
  lens->home();
  std::thread fault([] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    command("bridge refuse 1");
  });
  expect_error(ErrorCode::device_lost, [&] { lens->move_to(100); }, {"GPIO line 0"});
  fault.join();
  expect_error(ErrorCode::unavailable, [&] { lens->position(); }, {"moving from 0 to 100"});
  EXPECT_EQ(lens->home().position, 0) << "home makes it known again";
  EXPECT_EQ(truth("motor"), 8);
}

TEST_F(Gpio, IsFound) {
  for (const RigDriver* driver : all_rig_drivers()) {
    if (std::string_view(driver->name()) != "stepper") continue;
    const auto found = driver->find();
    const std::string text = "stepper:port=gpio,chip=" + chip().substr(chip().rfind('/') + 1);
    const auto one = std::find_if(found.begin(), found.end(), [&](const FoundHardware& hardware) {
      return hardware.text.starts_with(text);
    });
    ASSERT_NE(one, found.end());
    EXPECT_NE(one->description.find("cp210x, 4 lines"), std::string::npos) << one->description;
  }
}

TEST_F(Gpio, UnpluggingIsAnErrorAndTheBridgeCanBeOpenedAgain) {
  auto lens = open();
  lens->home();
  std::thread fault([] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    command("bridge unplug");
  });
  expect_error(ErrorCode::device_lost, [&] { lens->move_to(150); }, {"GPIO line"});
  fault.join();
  expect_error(ErrorCode::unavailable, [&] { lens->position(); });
  expect_error(ErrorCode::device_lost, [&] { lens->home(); });
  lens = nullptr;
  usb::wait_for_no_devices(10);
  ASSERT_EQ(command("bridge plug"), "ok");
  usb::wait_for_devices(false, true, 10);
  ::setenv("FATHOM_GPIOCHIP", usb::gpio_chip().c_str(), 1);  // it may have another number now
  lens = open();
  EXPECT_EQ(lens->home().position, 0);
  EXPECT_EQ(truth("motor"), 8);
}

}  // namespace
}  // namespace fathom::test
