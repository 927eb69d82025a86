// SPDX-License-Identifier: Apache-2.0
// The driver "stepper" on the kernel's parallel port: what reaches the pins.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/parport.h>
#include <linux/ppdev.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/error.hpp"
#include "hal/rig_driver.hpp"
#include "port_log.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fathom::test {
namespace {

constexpr const char* kPort = "/dev/parport0";
constexpr std::uint8_t kStep = 1, kDirection = 2;
/// The clocks inside and outside of the emulated machine agree to that; the noted time has 1 us.
constexpr double kClocks = 0.995;

/// The port without the driver under test.
class BarePort {
 public:
  BarePort() : fd_(::open(kPort, O_RDWR | O_CLOEXEC)) { EXPECT_EQ(::ioctl(fd_, PPCLAIM), 0); }
  ~BarePort() {
    ::ioctl(fd_, PPRELEASE);
    ::close(fd_);
  }
  void write(std::uint8_t data) { EXPECT_EQ(::ioctl(fd_, PPWDATA, &data), 0); }
  std::uint8_t read() {
    std::uint8_t data = 0;
    EXPECT_EQ(::ioctl(fd_, PPRDATA, &data), 0);
    return data;
  }

 private:
  int fd_;
};

class ParallelPort : public testing::Test {
 protected:
  std::unique_ptr<Lens> open(const std::string& keys) {
    OpenOptions options;
    options.camera = false;
    const std::string state = (folder / "state.json").string();
    return open_hardware(std::string("stepper:port=") + kPort + ",state=" + state + keys, options)
        .lens;
  }
  TemporaryFolder folder;
};

/// What a board and a motor would have made of the writes.
struct Reading {
  int position = 0, rises = 0, falls = 0, turns = 0;
  std::uint8_t other_bits_changed = 0;
  double shortest_step_s = 1e9, shortest_pulse_s = 1e9, shortest_setup_s = 1e9;
};

Reading read(std::uint8_t before, const std::vector<PortWrite>& writes) {
  Reading reading;
  std::uint8_t now = before;
  double rose_s = -1e9, turned_s = -1e9;
  for (const PortWrite& write : writes) {
    const auto changed = static_cast<std::uint8_t>(now ^ write.data);
    now = write.data;
    reading.other_bits_changed |= static_cast<std::uint8_t>(changed & ~(kStep | kDirection));
    if ((changed & kDirection) != 0) {
      ++reading.turns;
      turned_s = write.time_s;
    }
    if ((changed & kStep) == 0) continue;
    if ((now & kStep) == 0) {
      ++reading.falls;
      reading.shortest_pulse_s = std::min(reading.shortest_pulse_s, write.time_s - rose_s);
      continue;
    }
    ++reading.rises;
    reading.position += (now & kDirection) != 0 ? 1 : -1;
    reading.shortest_step_s = std::min(reading.shortest_step_s, write.time_s - rose_s);
    reading.shortest_setup_s = std::min(reading.shortest_setup_s, write.time_s - turned_s);
    rose_s = write.time_s;
  }
  return reading;
}

TEST_F(ParallelPort, GetsExactlyTheStepsAtTheThesisRate) {
  constexpr std::uint8_t kFound = 0xa4;
  BarePort().write(kFound);
  const PortLog log;
  ASSERT_TRUE(log.is_there()) << "the emulated machine notes no writes";
  {
    const auto lens = open(",pulse_us=2000,setup_us=1500,backlash=8,settle_ms=0");
    lens->declare_at(0);
    EXPECT_EQ(lens->move_to(30).position, 30);
    EXPECT_EQ(lens->move_to(20).position, 20);
  }
  const std::vector<PortWrite> writes = log.writes();
  const Reading reading = read(kFound, writes);
  EXPECT_EQ(reading.rises, 30 + 18 + 8) << "up, down too far, up again";
  EXPECT_EQ(reading.falls, reading.rises);
  EXPECT_EQ(reading.position, 20);
  EXPECT_EQ(reading.other_bits_changed, 0);
  EXPECT_GE(reading.shortest_step_s, kClocks * 0.04) << "25 a second";
  EXPECT_LT(reading.shortest_step_s, 0.08) << "and not much slower";
  EXPECT_GE(reading.shortest_pulse_s, kClocks * 0.002);
  EXPECT_GE(reading.shortest_setup_s, kClocks * 0.0015);
  ASSERT_FALSE(writes.empty());
  EXPECT_EQ(writes.back().data, kFound) << "left as it was found";
  EXPECT_EQ(BarePort().read(), kFound);
}

TEST_F(ParallelPort, AnswersOnOtherBitsAndTheOtherEdge) {
  BarePort().write(0xff);
  const PortLog log;
  {
    const auto lens = open(",step_bit=7,dir_bit=3,step_on=fall,out=low,limit=500,rate=500");
    lens->declare_at(10);
    lens->move_to(15);
  }
  int falls = 0;
  std::uint8_t now = 0xff;
  for (const PortWrite& write : log.writes()) {
    if ((now & 0x80) != 0 && (write.data & 0x80) == 0) {
      ++falls;
      EXPECT_EQ(write.data & 0x08, 0) << "out is low";
    }
    now = write.data;
    EXPECT_EQ(now | 0x88, 0xff) << "the other six";
  }
  EXPECT_EQ(falls, 5);
  EXPECT_EQ(now, 0xff);
}

TEST_F(ParallelPort, BelongsToOneProgram) {
  const auto lens = open("");
  expect_error(ErrorCode::unavailable, [&] { open(""); }, {kPort});
  const auto free = [&] { return OpenOptions{.camera = false}; };
  expect_error(ErrorCode::unavailable,
               [&] {
                 open_hardware(std::string("stepper:port=") + kPort +
                                   ",state=" + (folder / "another.json").string(),
                               free());
               },
               {"in use", kPort});
}

TEST_F(ParallelPort, IsFreeAgainAfterwards) {
  open("");
  EXPECT_NO_THROW(open(""));
}

/// The emulated port has nothing plugged in: ack, select and error are high, paper is low, and so
/// is the pin of busy.
TEST_F(ParallelPort, ReadsAHomeSwitchOnAStatusLine) {
  const std::string small = ",highest=6,home_margin=2,limit=500,rate=500,home_by=switch,home=";
  for (const char* high : {"ack", "select", "error"}) {
    expect_error(ErrorCode::device_lost, [&] { open(small + high)->home(); },
                 {"no home switch after 8 steps"});
  }
  for (const char* low : {"paper", "busy"}) {
    expect_error(ErrorCode::device_lost, [&] { open(small + low)->home(); },
                 {"stays closed for 6 steps"});
  }
}

TEST_F(ParallelPort, IsFound) {
  for (const RigDriver* driver : all_rig_drivers()) {
    if (std::string_view(driver->name()) != "stepper") continue;
    const auto found = driver->find();
    const auto port = std::find_if(found.begin(), found.end(), [](const FoundHardware& one) {
      return one.text == std::string("stepper:") + kPort;
    });
    ASSERT_NE(port, found.end());
    EXPECT_EQ(port->problem, "");
    EXPECT_TRUE(port->has_lens);
  }
}

}  // namespace
}  // namespace fathom::test
