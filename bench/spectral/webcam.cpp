// SPDX-License-Identifier: Apache-2.0
#include "bench/spectral/webcam.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "bench/honesty/grain.hpp"
#include "bench/honesty/recording.hpp"
#include "bench/honesty/thesis_rig.hpp"
#include "session/session.hpp"

namespace fathom {
namespace {

constexpr int kPictures = 52, kUnits = 5;  ///< Positions 0, 5 .. 255, as such lenses count.
constexpr int kSide = 160;                 ///< Of a picture, px: the window, and the wide one.
constexpr double kBreathing = 0.03;        ///< Of the magnification, from end to end.
constexpr double kBlurPx = 1 / 3.;         ///< Diameter that each picture adds,
constexpr double kRestPx = 1;              ///< and what is left at the focus.
constexpr double kNoise = 1.5;             ///< Grey values.
constexpr double kQuality = 0.3;           ///< JPEG at some 75 (bench/honesty/grain.hpp).
constexpr double kClose = 10;              ///< Units.

using Greys = std::vector<double>;

/// What is recorded: a piece of the rig's picture in focus, and where the lens has it so.
struct Recorded {
  const char* target = "";
  double focus = 0;  ///< As a number of a picture.
  int x = 0, y = 0;  ///< Of the middle of the piece, px.
};

Frame sharp_picture(const char* target, std::uint_fast32_t seed) {
  constexpr double kDistance = 2000;
  RigOptions options;
  options.rig = fmt::format("sim:target={},distance={},seed={},noise=0,drift=0,backlash=0", target,
                            kDistance, seed);
  Rig rig(options);
  return shoot(rig.camera(), rig.lens(), std::round(honesty::steps_of(kDistance)), {})
      .frame.clone();
}

/// A square piece, as a lens that breathes sees it.
Greys piece_of(const Frame& frame, const Recorded& what, double magnified) {
  const auto grey = [&](int x, int y) {
    return static_cast<double>(
        frame.at(std::clamp(x, 0, frame.width_px() - 1), std::clamp(y, 0, frame.height_px() - 1)));
  };
  const double middle_x = frame.width_px() / 2., middle_y = frame.height_px() / 2.;
  Greys piece;
  for (int row = 0; row < kSide; ++row) {
    for (int col = 0; col < kSide; ++col) {
      const double x = middle_x + (what.x - kSide / 2. + col - middle_x) / magnified;
      const double y = middle_y + (what.y - kSide / 2. + row - middle_y) / magnified;
      const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
      const double right = x - left, low = y - top;
      piece.push_back((1 - low) * ((1 - right) * grey(left, top) + right * grey(left + 1, top)) +
                      low * ((1 - right) * grey(left, top + 1) + right * grey(left + 1, top + 1)));
    }
  }
  return piece;
}

/// Along rows, then turned: twice is both axes.
Greys blurred_and_turned(const Greys& from, const std::vector<double>& kernel) {
  const int reach = static_cast<int>(kernel.size() / 2);
  Greys to(from.size());
  for (int row = 0; row < kSide; ++row) {
    for (int col = 0; col < kSide; ++col) {
      double sum = 0;
      for (int i = -reach; i <= reach; ++i)
        sum += kernel[i + reach] * from[row * kSide + std::clamp(col + i, 0, kSide - 1)];
      to[col * kSide + row] = sum;
    }
  }
  return to;
}

/// Of many small lenses: a Gaussian of the second moment of a disc of this diameter.
Greys blurred(const Greys& greys, double diameter_px) {
  const double sigma = diameter_px / 4;
  const int reach = static_cast<int>(std::ceil(4 * sigma));
  std::vector<double> kernel;
  double sum = 0;
  for (int i = -reach; i <= reach; ++i) {
    kernel.push_back(std::exp(-0.5 * std::pow(i / sigma, 2)));
    sum += kernel.back();
  }
  for (double& k : kernel) k /= sum;
  return blurred_and_turned(blurred_and_turned(greys, kernel), kernel);
}

Frame picture_of(const Frame& sharp, const Recorded& what, int number, std::mt19937& random) {
  const double breath = 1 + kBreathing * (static_cast<double>(number) / (kPictures - 1) - 0.5);
  Greys greys =
      blurred(piece_of(sharp, what, breath), std::hypot(kBlurPx * (number - what.focus), kRestPx));
  std::normal_distribution<double> noise(0, kNoise);
  for (double& grey : greys) grey += noise(random);
  greys = honesty::grained(std::move(greys), kSide, honesty::Grain::jpeg, kQuality, kNoise);
  std::vector<std::uint8_t> pixels;
  for (const double grey : greys)
    pixels.push_back(static_cast<std::uint8_t>(std::clamp(std::round(grey), 0.0, 255.0)));
  return {kSide, kSide, std::move(pixels)};
}

/// Every so many pictures, from one of the first on.
Focus focus_of(const std::vector<Frame>& all, int first, int every, SearchMethod search) {
  std::vector<Frame> pictures;
  std::vector<double> positions;
  for (int i = first; i < kPictures; i += every) {
    pictures.push_back(all[i].clone());
    positions.push_back(kUnits * i);
  }
  RigOptions options;
  options.rig = "a recording";
  options.window = Window{(kSide - 64) / 2, (kSide - 64) / 2, 64};
  Rig rig(options, honesty::play(std::move(pictures), std::move(positions)));
  FocusRequest request;
  request.search = search;
  Observer nobody;
  return *Session(rig).focus(request, nobody).focus;
}

struct Tally {
  int windows = 0, close = 0, declined = 0, by_spectra = 0;
  double squares = 0, ratios = 0;
};

void add(Tally& tally, const Focus& all, const Focus& few) {
  ++tally.windows;
  if (few.result() != FocusResult::focused) return void(++tally.declined);
  const double apart = few.position() - all.position();
  tally.close += std::abs(apart) <= kClose;
  tally.by_spectra += few.spectral_end == SpectralEnd::found;
  tally.squares += apart * apart;
  tally.ratios += std::pow(apart / std::hypot(all.peak.sigma, few.peak.sigma), 2);
}

Recorded any_piece(std::mt19937& random) {
  constexpr const char* kTargets[] = {"usaf", "seedling"};
  constexpr double kMargin = 12;  // pictures on either side of the focus
  return {.target = kTargets[random() % 2],
          .focus = honesty::pick(random, kMargin, kPictures - 1 - kMargin),
          .x = static_cast<int>(honesty::pick(random, 88, 168)),
          .y = static_cast<int>(honesty::pick(random, 88, 168))};
}

}  // namespace

bool measure_webcam(int windows, unsigned seed, bool list) {
  std::mt19937 random(seed);
  Tally tally;
  int without = 0;  // windows without a focus even in all pictures
  while (tally.windows < windows && without < windows) {
    const Recorded what = any_piece(random);
    const Frame sharp = sharp_picture(what.target, random() % 1000000);
    std::vector<Frame> all;
    for (int i = 0; i < kPictures; ++i) all.push_back(picture_of(sharp, what, i, random));
    const Focus whole = focus_of(all, 0, 1, SearchMethod::automatic);
    const int first = static_cast<int>(random() % 10);
    const Focus few = focus_of(all, first, 10, SearchMethod::spectral);
    if (list)
      fmt::print(
          "{} at {},{}: focus {:.1f}, all {} {:.1f} +- {:.1f}, from {} {} {:.1f} +- {:.1f} {}\n",
          what.target, what.x, what.y, kUnits * what.focus, to_string(whole.result()),
          whole.position(), whole.peak.sigma, first, to_string(few.result()), few.position(),
          few.peak.sigma, few.spectral_end ? to_string(*few.spectral_end) : "by scores");
    if (whole.result() != FocusResult::focused) {
      ++without;
      continue;
    }
    add(tally, whole, few);
  }
  const double told = tally.windows - tally.declined;
  fmt::print("like a webcam's: {} windows of 52 pictures, every tenth given\n", tally.windows);
  fmt::print("  within {:g} units of the focus of all: {} of {}; {} declined, {} told by spectra\n",
             kClose, tally.close, tally.windows, tally.declined, tally.by_spectra);
  fmt::print("  apart        {:.1f} units rms, {:.2f} sigmas rms\n",
             std::sqrt(tally.squares / told), std::sqrt(tally.ratios / told));
  return 5 * tally.close >= 4 * windows;
}

}  // namespace fathom
