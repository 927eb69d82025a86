// SPDX-License-Identifier: Apache-2.0
#include "fake_gige.hpp"

#include <arv.h>

#include <chrono>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "engine/file.hpp"
#include "hal/rig_driver.hpp"

namespace fathom::test {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t kLensAddress = 0x400;
constexpr std::uint32_t kClockAddress = 0x410;

constexpr const char* kLens = R"(
  <Integer Name="FocusPos" NameSpace="Custom"><pValue>FocusPosRegister</pValue>
    <Min>0</Min><Max>1200</Max><Inc>1</Inc><Unit>steps</Unit></Integer>
  <IntReg Name="FocusPosRegister"><Address>0x400</Address><Length>4</Length><AccessMode>RW</AccessMode>
    <pPort>Device</pPort><Sign>Unsigned</Sign><Endianess>BigEndian</Endianess></IntReg>
  <Float Name="FocalPower" NameSpace="Custom"><pValue>FocalPowerRegister</pValue>
    <Min>-2</Min><Max>3</Max><Unit>dpt</Unit></Float>
  <FloatReg Name="FocalPowerRegister"><Address>0x420</Address><Length>4</Length>
    <AccessMode>RW</AccessMode><pPort>Device</pPort><Endianess>BigEndian</Endianess></FloatReg>
)";

constexpr const char* kClock = R"(
  <Command Name="TimestampLatch" NameSpace="Custom"><pValue>TimestampLatchRegister</pValue>
    <CommandValue>1</CommandValue></Command>
  <IntReg Name="TimestampLatchRegister"><Address>0x408</Address><Length>4</Length>
    <AccessMode>RW</AccessMode><pPort>Device</pPort><Sign>Unsigned</Sign>
    <Endianess>BigEndian</Endianess></IntReg>
  <Integer Name="TimestampLatchValue" NameSpace="Custom"><pValue>TimestampLatchValueRegister</pValue>
  </Integer>
  <IntReg Name="TimestampLatchValueRegister"><Address>0x410</Address><Length>8</Length>
    <AccessMode>RO</AccessMode><pPort>Device</pPort><Sign>Unsigned</Sign>
    <Endianess>BigEndian</Endianess></IntReg>
)";

/// What Aravis' fake says of itself, and more.
std::string description(bool has_clock) {
  ArvFakeCamera* const plain = arv_fake_camera_new("plain");
  std::size_t size = 0;
  const char* const text = arv_fake_camera_get_genicam_xml(plain, &size);
  std::string xml(text, size);
  g_object_unref(plain);
  xml.insert(xml.find("</RegisterDescription>"), std::string(kLens) + (has_clock ? kClock : ""));
  return xml;
}

}  // namespace

FakeGige::FakeGige(bool has_clock)
    : begin_([] { return [](int, int) { return std::uint8_t{128}; }; }) {
  const std::string file = (folder_ / "camera.xml").string();
  write_file(file, description(has_clock));
  camera_ = arv_gv_fake_camera_new_full(kAddress, "TEST1", file.c_str());
  if (camera_ == nullptr || arv_gv_fake_camera_is_running(camera_) == 0)
    throw std::runtime_error("the fake camera does not start; is its port 3956 taken?");
  arv_fake_camera_set_fill_pattern(registers(), fill, this);
  if (has_clock) ticking_ = std::thread([this] { tick(); });
}

FakeGige::~FakeGige() { vanish(); }

void FakeGige::vanish() {
  ends_ = true;
  if (ticking_.joinable()) ticking_.join();
  if (camera_ != nullptr) g_object_unref(camera_);
  camera_ = nullptr;
}

ArvFakeCamera* FakeGige::registers() const { return arv_gv_fake_camera_get_fake_camera(camera_); }

/// The fake latches nothing, so that what could be latched is always now. Its frames are stamped on
/// the clock of the wall.
void FakeGige::tick() {
  while (!ends_) {
    const std::uint64_t now_ns =
        GUINT64_TO_BE(static_cast<std::uint64_t>(g_get_real_time()) * 1000);
    arv_fake_camera_write_memory(registers(), kClockAddress, sizeof now_ns, &now_ns);
    std::this_thread::sleep_for(100us);
  }
}

int FakeGige::lens_position() const { return static_cast<int>(read(kLensAddress)); }

std::uint32_t FakeGige::read(std::uint32_t address) const {
  std::uint32_t value = 0;
  arv_fake_camera_read_register(registers(), address, &value);
  return value;
}

void FakeGige::write(std::uint32_t address, std::uint32_t value) {
  arv_fake_camera_write_register(registers(), address, value);
}

void FakeGige::lose(double ratio) { g_object_set(camera_, "gvsp-lost-ratio", ratio, nullptr); }

void FakeGige::fill(ArvBuffer* buffer, void* self, std::uint32_t, std::uint32_t,
                    std::uint32_t format) {
  const Painter painter = static_cast<FakeGige*>(self)->begin_();
  std::size_t size = 0;
  auto* bytes = static_cast<std::uint8_t*>(const_cast<void*>(arv_buffer_get_data(buffer, &size)));
  const int width = arv_buffer_get_image_width(buffer),
            height = arv_buffer_get_image_height(buffer);
  const bool is_wide = format == ARV_PIXEL_FORMAT_MONO_16;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::uint8_t grey = painter(x, y);
      if (is_wide) *bytes++ = 0;
      *bytes++ = grey;
    }
  }
}

struct SimulatedScene::Rig {
  Hardware hardware;
  double stands = -1;
  Frame frame;
};

SimulatedScene::SimulatedScene(double distance_mm, const std::string& keys)
    : rig_(std::make_unique<Rig>()) {
  rig_->hardware = open_hardware(
      "sim:noise=0,drift=0,backlash=0,start=0,distance=" + std::to_string(distance_mm) + keys);
}

SimulatedScene::~SimulatedScene() = default;

Painter SimulatedScene::at(double lens_step) {
  const double step = std::round(lens_step);
  if (step != rig_->stands) {
    const Arrival arrival = rig_->hardware.lens->move_to(step);
    do {
      rig_->frame = *rig_->hardware.camera->grab(10s);
    } while (rig_->frame.exposure.start_ns < arrival.settled_ns);
    rig_->stands = step;
  }
  return [this](int x, int y) {
    const Frame& frame = rig_->frame;
    return static_cast<std::uint8_t>(frame.at(x % frame.width_px(), y % frame.height_px()));
  };
}

}  // namespace fathom::test
