// SPDX-License-Identifier: Apache-2.0
#include "pulled_desks.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "engine/error.hpp"
#include "engine/file.hpp"
#include "hal/clock.hpp"
#include "hal/drivers/serial/profile.hpp"
#include "hal/drivers/simulated/thin_lens.hpp"
#include "hal/rig_driver.hpp"
#include "indi_scene.hpp"
#include "tests/unit/hal/alpaca/fake_server.hpp"
#include "tests/unit/hal/aravis/fake_gige.hpp"
#include "tests/unit/hal/serial/simulated_stage.hpp"

namespace fathom::test {
namespace {

constexpr double kTarget_mm = 1800;
constexpr double kTravel_steps = 1200;  // of the simulated lens that every desk looks through

double focus_of(double travel) {
  return simulated::focused_position_steps(kTarget_mm) / kTravel_steps * travel;
}

/// GRBL's profile without the wait for a board that starts anew: a pseudo-terminal resets nobody.
std::string quick_grbl() {
  for (const serial::KnownProfile& known : serial::known_profiles()) {
    std::string text(known.text);
    const std::string wait = "wait_s = 3";
    const std::size_t at = text.find(wait);
    if (known.name == "grbl" && at != std::string::npos)
      return text.replace(at, wait.size(), "wait_s = 0");
  }
  throw Error(ErrorCode::bad_argument, "the profile of GRBL waits otherwise than this test knows");
}

/// A GigE camera beside a rail that forgets where it is when it is switched off.
class RailDesk final : public PulledDesk {
 public:
  RailDesk(Cable cable, const std::filesystem::path& folder)
      : cable_(cable),
        file_((folder / "rail.toml").string()),
        state_(folder / "rail.json"),
        port_(folder / "ttyRail"),
        profile_(folder / "quick.toml"),
        scene_(kTarget_mm),
        motor_(std::make_shared<StageMotor>(kRate)) {
    write_file(profile_.string(), quick_grbl());
    std::filesystem::remove(state_);
    camera_.paint([this] {
      ++pictures_;
      return scene_.at(motor_->position() / kTravel * kTravel_steps);
    });
    plug_in();
    open_hardware(file_, {.camera = false}).lens->declare_at(0);
  }

  std::string rig() const override { return file_; }
  double focus() const override { return focus_of(kTravel); }
  double step() const override { return kTravel / kTravel_steps; }
  std::string name() const override {
    return cable_ == Cable::camera ? FakeGige::kAddress : port_.string();
  }
  void pull() override { cable_ == Cable::camera ? camera_.vanish() : stage_->unplug(); }

  std::string wrong_belief() override {
    if (cable_ == Cable::camera && motor_->is_moving()) return "the rail still moves";
    while (motor_->is_moving()) sleep_until_ns(monotonic_now_ns() + 1'000'000);
    plug_in();
    try {
      const double believed = open_hardware(file_, {.camera = false}).lens->position();
      if (std::abs(believed - motor_->position()) <= kStep) return {};
      return fmt::format("it is believed at {}, and is at {}", believed, motor_->position());
    } catch (const Error& error) {
      // A rail whose camera went had its cable, and knows.
      if (cable_ == Cable::stage && error.code() == ErrorCode::unavailable) return {};
      return error.what();
    }
  }

 private:
  static constexpr double kTravel = 80, kRate = 200, kStep = 0.05;

  /// The same rail at the same port: a name that stays, as those under /dev/serial/by-id do.
  void plug_in() {
    stage_ = nullptr;
    stage_ = std::make_unique<SimulatedStage>(motor_, make_dialect("grbl", *motor_));
    std::filesystem::remove(port_);
    std::filesystem::create_symlink(stage_->port(), port_);
    write_file(file_, fmt::format("[camera]\ndriver = \"aravis\"\ncamera = \"{}\"\nwidth = 256\n"
                                  "height = 240\n[lens]\ndriver = \"serial\"\nprofile = \"{}\"\n"
                                  "port = \"{}\"\nstate = \"{}\"\nlowest = 0\nhighest = {}\n"
                                  "step = {}\nsettle_ms = 1\n",
                                  FakeGige::kAddress, profile_.string(), port_.string(),
                                  state_.string(), kTravel, kStep));
  }

  Cable cable_;
  std::string file_;
  std::filesystem::path state_, port_, profile_;
  SimulatedScene scene_;
  std::shared_ptr<StageMotor> motor_;
  std::unique_ptr<SimulatedStage> stage_;
  FakeGige camera_;
};

class AlpacaDesk final : public PulledDesk {
 public:
  AlpacaDesk()
      : scene_(kTarget_mm),
        server_({.width_px = 256,
                 .height_px = 240,
                 .brightest = 255,
                 .travel = 1200,
                 .most_at_once = 500,
                 .steps_per_s = 5000},
                [this](int x, int y, double step) {
                  if (x == 0 && y == 0) ++pictures_;
                  if (step != drawn_) painter_ = scene_.at(drawn_ = step);
                  return int{painter_(x, y)};
                }) {}

  std::string rig() const override { return server_.rig(",exposure_ms=2,settle_ms=1"); }
  double focus() const override { return focus_of(kTravel_steps); }
  double step() const override { return 1; }
  std::string name() const override { return "127.0.0.1:" + std::to_string(server_.port()); }
  void pull() override { server_.die(); }
  /// Nobody can be asked: the server is gone, and keeps count itself.
  std::string wrong_belief() override { return {}; }

 private:
  SimulatedScene scene_;
  double drawn_ = -1;
  Painter painter_;
  FakeAlpaca server_;
};

class IndiDesk final : public PulledDesk {
 public:
  IndiDesk() : scene_(kTarget_mm), server_(std::in_place), address_(server_->address()) {
    show_scene(*server_, scene_, kTravel_steps, [this] { ++pictures_; });
  }

  std::string rig() const override {
    return "indi:server=" + address_ + ",exposure_ms=2,settle_ms=1";
  }
  double focus() const override { return focus_of(kIndiTravel); }
  double step() const override { return kIndiTravel / kTravel_steps; }
  std::string name() const override { return address_; }
  void pull() override { server_.reset(); }
  std::string wrong_belief() override { return {}; }

 private:
  SimulatedScene scene_;
  std::optional<FakeServer> server_;
  std::string address_;
};

}  // namespace

const char* name_of(Cable cable) {
  switch (cable) {
    case Cable::stage:
      return "stage";
    case Cable::camera:
      return "camera";
    case Cable::alpaca:
      return "Alpaca server";
    case Cable::indi:
      return "INDI server";
  }
  return "";
}

std::unique_ptr<PulledDesk> make_desk(Cable cable, const std::filesystem::path& folder) {
  switch (cable) {
    case Cable::stage:
    case Cable::camera:
      return std::make_unique<RailDesk>(cable, folder);
    case Cable::alpaca:
      return std::make_unique<AlpacaDesk>();
    case Cable::indi:
      return std::make_unique<IndiDesk>();
  }
  throw Error(ErrorCode::bad_argument, "no such cable");
}

}  // namespace fathom::test
