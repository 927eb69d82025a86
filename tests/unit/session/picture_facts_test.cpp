// SPDX-License-Identifier: Apache-2.0
#include "session/picture_facts.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "backends/backends.hpp"
#include "engine/selection.hpp"
#include "engine/tables.hpp"
#include "session/session.hpp"
#include "tests/support/frames.hpp"

namespace fathom::test {
namespace {

constexpr Window kWindow{0, 0, 64};

/// Noise-like texture of some grey levels on a card of this grey value.
Frame card(int grey) {
  Frame texture = make_frame("random", 8, 64, 64, 5);
  std::vector<std::uint16_t> pixels;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x)
      pixels.push_back(static_cast<std::uint16_t>(grey + static_cast<int>(texture.at(x, y)) / 16));
  }
  return Frame(64, 64, std::move(pixels));
}

class Bare : public ::testing::TestWithParam<const char*> {
 protected:
  const MetricSpec spec = MetricSpec::parse(GetParam());
  Selection selection = select_device(all_backends(), "cpu", spec, 1);
  std::unique_ptr<Plan> plan = selection.device->plan(spec, 1);
  BrightnessShare share{*selection.device, spec};

  double bare_score(const Frame& frame) {
    return BrightnessShare::without(plan->score(frame, kWindow), share.of(frame, kWindow));
  }
};

TEST_P(Bare, DoesNotDependOnBrightness) {
  const double dark = bare_score(card(500));
  EXPECT_GT(dark, 0);
  EXPECT_NEAR(bare_score(card(2000)) / dark, 1, 2e-3);
}

TEST_P(Bare, IsNothingOfABlankCard) {
  const Frame blank(64, 64, std::vector<std::uint8_t>(64 * 64, 150));
  EXPECT_LT(bare_score(blank), 1e-3 * bare_score(card(150)));
}

INSTANTIATE_TEST_SUITE_P(Metrics, Bare,
                         ::testing::Values("fft:64:hann", "fft:64:hann:power:band=0-0.25",
                                           "fft:64:tukey=0.5:power", "walsh-sequency:64:hann",
                                           "walsh-sequency:64"));

/// The share from a whole spectrum, of which a constant reaches |u|, |v| <= 1 under a raised cosine.
double slow_share(Device& device, const MetricSpec& spec, const Frame& frame,
                  const Window& window) {
  const auto n = static_cast<std::size_t>(spec.n), half = n / 2;
  const auto plan = device.plan(spec, 1);
  std::vector<std::complex<double>> all(n * n), flat(n * n);
  plan->spectrum(frame, window, all);
  plan->spectrum(Frame(spec.n, spec.n, std::vector<std::uint8_t>(n * n, 128)), {0, 0, spec.n},
                 flat);
  const auto weights = tables::moment_weights(spec);
  const auto mass = [&](std::complex<double> c) { return spec.power ? std::norm(c) : std::abs(c); };
  double share = 0;
  for (std::size_t v = half - 1; v <= half + 1; ++v) {
    for (std::size_t u = half - 1; u <= half + 1; ++u) {
      const auto bare =
          all[v * n + u] - all[half * n + half] * flat[v * n + u] / flat[half * n + half];
      const double weight = weights[(v + half) % n * n + (u + half) % n];
      share += weight * (mass(all[v * n + u]) - mass(bare));
    }
  }
  return share / std::pow(spec.n, 4) / 2;
}

TEST(BrightnessShare, IsThatOfTheWholeSpectrum) {
  for (const char* const text :
       {"fft:64:hann", "fft:32:hann:power", "fft:16:hann:band=0.05-0.25"}) {
    const MetricSpec spec = MetricSpec::parse(text);
    const Selection selection = select_device(all_backends(), "reference", spec, 1);
    BrightnessShare share(*selection.device, spec);
    for (const int bits : {8, 12, 16}) {
      const Frame frame = make_frame("random", bits, 83, 77, 5);
      const Window window{11, 9, spec.n};
      const double slow = slow_share(*selection.device, spec, frame, window);
      EXPECT_NEAR(share.of(frame, window) / slow, 1, 1e-9) << text << " of " << bits << " bits";
    }
  }
}

TEST(PictureReader, ReadsWhatItWasMade) {
  const MetricSpec spec = MetricSpec::parse("walsh-sequency:64");
  const Selection selection = select_device(all_backends(), "cpu", spec, 1);
  PictureReader reader(*selection.device, spec, kWindow);
  const Frame frame = make_frame("random", 8, 64, 64, 9);
  double sum = 0, squares = 0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) sum += frame.at(x, y), squares += frame.at(x, y) * frame.at(x, y);
  }
  const double mean = sum / 4096, deviation = std::sqrt(squares / 4096 - mean * mean);
  const PictureFacts facts = reader.read(frame);
  EXPECT_NEAR(facts.brightness, mean, 1e-9);
  EXPECT_NEAR(facts.deviation, deviation, 1e-6);
  EXPECT_NEAR(facts.noise / deviation, 1, 0.1) << "white noise is all noise";
  for (const double part : facts.parts) EXPECT_GT(part, 0);
  double corner = 0;
  for (int y = 32; y < 64; ++y) {
    for (int x = 16; x < 48; ++x) corner += frame.at(x, y);
  }
  EXPECT_NEAR(facts.part_brightness[7], corner / 1024, 1e-9) << "below, in the middle";
}

TEST(PictureReader, LeavesOutPartsThatTheMetricDoesNotKnow) {
  for (const char* const text : {"fft:8", "fft:32:hann:band=0-0.04"}) {
    const MetricSpec spec = MetricSpec::parse(text);
    const Selection selection = select_device(all_backends(), "cpu", spec, 1);
    PictureReader reader(*selection.device, spec, {0, 0, spec.n});
    EXPECT_EQ(reader.read(card(100)).parts, PictureFacts{}.parts) << text;
  }
}

}  // namespace
}  // namespace fathom::test
