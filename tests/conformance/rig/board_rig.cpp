// SPDX-License-Identifier: Apache-2.0
#include "board_rig.hpp"

#include <algorithm>
#include <cmath>

#include "hal/clock.hpp"
#include "tests/unit/hal/stepper/fake_board.hpp"

namespace fathom::test {
namespace {

constexpr int kLargest_px = 64;
constexpr double kShortest_ms = 1, kLongest_ms = 20;

/// Every place of the lens is another grey. Frames are exposed when they are asked for.
class BoardCamera final : public Camera {
 public:
  explicit BoardCamera(std::shared_ptr<const FakeBoard> board) : board_(std::move(board)) {}

  std::string description() const override { return "camera beside a made-up driver board"; }
  CameraSettings settings() const override { return settings_; }
  bool is_live() const override { return true; }

  Validity validate(CameraSettings& wished) const override {
    if (wished.width_px <= 0 || wished.height_px <= 0 || !(wished.exposure_ms > 0)) {
      return Validity::refused;
    }
    const CameraSettings possible{std::min(wished.width_px, kLargest_px),
                                  std::min(wished.height_px, kLargest_px), Depth::bits16,
                                  std::clamp(wished.exposure_ms, kShortest_ms, kLongest_ms)};
    if (wished == possible) return Validity::valid;
    wished = possible;
    return Validity::adjusted;
  }

  void apply(const CameraSettings& settings) override {
    CameraSettings checked = settings;
    if (validate(checked) != Validity::valid) {
      throw Error(ErrorCode::unsupported, "the camera beside the board cannot do that");
    }
    settings_ = settings;
  }

  std::optional<Frame> grab(std::chrono::milliseconds timeout) override {
    const std::int64_t exposure_ns = std::llround(settings_.exposure_ms * 1e6);
    if (exposure_ns > std::chrono::nanoseconds(timeout).count()) return std::nullopt;
    Exposure exposure{monotonic_now_ns(), 0};
    sleep_until_ns(exposure.start_ns + exposure_ns);
    exposure.end_ns = monotonic_now_ns();
    const double place = board_->mean_lens(exposure);
    const auto grey = static_cast<std::uint16_t>(std::lround(200 + 100 * place));
    const std::size_t pixels = static_cast<std::size_t>(settings_.width_px) * settings_.height_px;
    Frame frame(settings_.width_px, settings_.height_px, std::vector<std::uint16_t>(pixels, grey));
    frame.exposure = exposure;
    frame.lens_position = place;
    return frame;
  }

 private:
  std::shared_ptr<const FakeBoard> board_;
  CameraSettings settings_{24, 16, Depth::bits16, 5};
};

}  // namespace

Hardware open_board_rig(const OpenOptions& options) {
  static const TemporaryFolder folder;
  const RigSettings keys("board", {{"port", "/dev/none"},
                                   {"state", (folder / "state.json").string()},
                                   {"highest", "100"},
                                   {"limit", "500"},
                                   {"rate", "500"},
                                   {"home_rate", "500"},
                                   {"backlash", "8"},
                                   {"settle_ms", "2"},
                                   {"home_by", "stop"},
                                   {"home_position", "-6"}});  // so that the lens's 0 is its own
  const auto board = std::make_shared<FakeBoard>(stepper::monotonic_time());
  board->play = 6;
  board->top = 150;
  auto lens = std::make_unique<stepper::StepperLens>(
      stepper::Settings::read(keys), std::make_unique<FakeLines>(board), stepper::monotonic_time(),
      options.stop_requests);
  lens->declare_at(0);
  return {std::make_unique<BoardCamera>(board), std::move(lens), nullptr};
}

}  // namespace fathom::test
