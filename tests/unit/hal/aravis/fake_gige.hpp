// SPDX-License-Identifier: Apache-2.0
// A GigE Vision camera on this computer's loopback: Aravis' own fake, which speaks the protocol, with a
// lens, a clock that can be latched, and pictures of the test's choice. There is one at a time: the
// protocol has one port.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "tests/support/temporary_folder.hpp"

typedef struct _ArvGvFakeCamera ArvGvFakeCamera;
typedef struct _ArvFakeCamera ArvFakeCamera;
typedef struct _ArvBuffer ArvBuffer;

namespace fathom::test {

/// A grey value, 0 to 255, of a pixel.
using Painter = std::function<std::uint8_t(int x, int y)>;

class FakeGige {
 public:
  /// Its registers that the camera's lens has: "FocusPos", 0 to kLensTravel steps.
  static constexpr int kLensTravel = 1200;
  static constexpr const char* kAddress = "127.0.0.1";

  /// Whether frames say when they were taken on a clock that can be latched.
  explicit FakeGige(bool has_clock = false);
  ~FakeGige();

  /// Asked in the camera's own thread; a picture is begun, and its pixels are asked for. Before
  /// anything is opened.
  void paint(std::function<Painter()> begin) { begin_ = std::move(begin); }

  int lens_position() const;
  /// Of packets, 0 to 1.
  void lose(double ratio);
  /// The cable is pulled: nothing is answered any more.
  void vanish();
  /// The value of one of its registers.
  std::uint32_t read(std::uint32_t address) const;
  void write(std::uint32_t address, std::uint32_t value);

 private:
  static void fill(ArvBuffer* buffer, void* self, std::uint32_t exposure_us, std::uint32_t gain,
                   std::uint32_t format);
  ArvFakeCamera* registers() const;
  void tick();

  TemporaryFolder folder_;
  ArvGvFakeCamera* camera_ = nullptr;
  std::function<Painter()> begin_;
  std::atomic<bool> ends_ = false;
  std::thread ticking_;
};

/// What the simulated rig shows where its lens stands at a step, of its size and repeated beyond it.
/// distance_mm: of the target. keys: more of "sim:".
class SimulatedScene {
 public:
  explicit SimulatedScene(double distance_mm, const std::string& keys = "");
  ~SimulatedScene();
  Painter at(double lens_step);

 private:
  struct Rig;
  std::unique_ptr<Rig> rig_;
};

}  // namespace fathom::test
