// SPDX-License-Identifier: Apache-2.0
// How a lens blurs: the diameter of the disc of confusion at a lens position, and what that leaves
// of the power in a ring of spatial frequency (Hopkins 1955, Stokseth 1969; docs/spectral.md).
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

namespace fathom {

/// What a point becomes out of focus.
enum class BlurShape {
  disc,  ///< Uniform: rays through a round aperture.
  gaussian,  ///< Of the same second moment, sigma = diameter / 4: what many small lenses come nearer to.
};

/// "disc", "gaussian".
const char* to_string(BlurShape shape) noexcept;
/// Throws Error(bad_argument), listing the names, for another.
BlurShape parse_blur_shape(std::string_view name);

/// How blur follows from the lens's position.
struct BlurModel {
  double px_per_unit = 0;     ///< Diameter, px, that each unit of travel away from the focus adds.
  double rest_px = 0.7;       ///< Diameter that is left at the focus: pixel, lens, motion.
  double uncertainty = 0.03;  ///< Standard uncertainty of px_per_unit, a part of it.
  BlurShape shape = BlurShape::disc;

  /// Diameter at this distance from the focus, px.
  double diameter_px(double from_focus) const;
  /// Units of travel that add a blur of this diameter.
  double units(double px) const { return px / px_per_unit; }

  bool operator==(const BlurModel&) const = default;
};

/// Of a microscope, per um of travel: the rays' cone, and at the focus the diffraction's own blur.
/// pixel_um: side of a pixel on the object. Throws Error(bad_argument) for an aperture outside of 0
/// to 1.49 (from 1 on in oil, of index 1.515; a dry lens has less), or a length that is not above 0.
BlurModel blur_of_microscope(double aperture, double wavelength_nm, double pixel_um);

/// Throws Error(bad_argument) unless all numbers are finite, and px_per_unit is above 0.
void require_valid(const BlurModel& model);

/// So many rings a window of this side is looked at in; 0 for one that is too small.
int rings_of_side(int n);

/// The transfer function of blur, signed, of diameter c at frequency f, by x = pi c f.
class TransferTable {
 public:
  /// largest: x up to which it is tabulated; beyond, it is as there.
  TransferTable(BlurShape shape, double largest);

  double at(double x) const { return between(amplitude_, x); }
  double squared(double x) const { return between(squared_, x); }

 private:
  static double between(const std::vector<double>& values, double x);

  std::vector<double> amplitude_, squared_;
};

/// What blur leaves of the power in the rings of a window (metric fft:N:hann:power:rings=K with
/// K = rings_of_side(N)): the mean over each ring of the squared transfer function, tabulated.
class DefocusLaw {
 public:
  /// Made once for each side and shape. n: with rings_of_side(n) > 0.
  static const DefocusLaw& of(int n, BlurShape shape);

  int side() const { return n_; }
  int rings() const { return rings_; }
  /// [k] coefficients in ring k.
  std::span<const float> counts() const { return counts_; }
  /// Sum of the squared taper over N^4: what white noise of variance 1 puts into every ring.
  double white_power() const { return white_power_; }

  /// [k] squared transfer at a diameter of blur, px, and its derivative by the diameter; beyond
  /// one window's side as there.
  void transfer(double diameter_px, std::span<float> squared, std::span<float> slope) const;

  /// The same of a picture that is the mean of several, as of a lens that goes on while it is exposed:
  /// their amplitudes add up before they are squared. weights: of the diameters; their sum is 1.
  void transfer_of_mean(std::span<const double> diameters_px, std::span<const double> weights,
                        std::span<float> squared) const;

 private:
  DefocusLaw(int n, BlurShape shape);

  /// A part of a ring: coefficients of nearly one frequency.
  struct Strip {
    double frequency = 0;  ///< Mean, cycles per pixel.
    double count = 0;
  };
  static constexpr int kStrips = 4;
  using Ring = std::array<Strip, kStrips>;
  static std::vector<Ring> rings_of(int n, int rings);

  int n_, rings_;
  double white_power_ = 0;
  std::vector<Ring> strips_;
  TransferTable transfer_;
  std::vector<float> counts_;
  std::vector<float> table_;  // [diameter][ring]
};

}  // namespace fathom
