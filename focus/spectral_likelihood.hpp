// SPDX-License-Identifier: Apache-2.0
// How likely pictures are, by their ring powers, for a focus at some place and a lens that blurs in
// some way (docs/spectral.md, "The estimator").
#pragma once

#include <array>
#include <span>
#include <vector>

#include "blur.hpp"
#include "curve.hpp"

namespace fathom {

/// Rings of this side in a picture; null where there are none.
const RingPowers* rings_in(const PictureFacts& picture, int side);

/// Degrees of freedom of a coefficient under a raised cosine, which makes neighbours alike.
inline constexpr float kRingFreedom = 1 / 1.5F;

/// One number a ring; what is beyond the last ring of a window is 0.
inline constexpr int kMostRingsFitted = 24;
using RingRow = std::array<float, kMostRingsFitted>;

/// One picture, its powers in units of the least noise of all.
struct RingPicture {
  double position = 0;
  OnTheWay way = {};  ///< All 0 for a lens at rest.
  RingRow powers{};
};

/// The pictures, and how likely they are for each place of the focus.
class SpectralLikelihood {
 public:
  /// Those evaluations that have rings of this side. side: with rings_of_side(side) > 0.
  SpectralLikelihood(std::span<const Evaluation> evaluations, int side, const BlurModel& model);

  std::size_t size() const { return pictures_.size(); }
  int side() const { return law_->side(); }
  const BlurModel& model() const { return model_; }
  const std::vector<RingPicture>& pictures() const { return pictures_; }
  /// Of the squares in a cost.
  double freedom() const;

  static constexpr int kRounds = 4;

  struct Cost {
    double total = 0;        ///< -2 ln of the likelihood, but for a constant.
    double chi_squared = 0;  ///< The squares in it.
  };

  /// For a focus at this position. rounds: of least squares; few tell the places where costs are least,
  /// and no more.
  Cost at(double focus, int rounds = kRounds) const;
  /// If the lens changed nothing.
  Cost unchanged() const;

  /// The same pictures through a lens that blurs otherwise.
  SpectralLikelihood with(const BlurModel& model) const;

 private:
  struct Foretold;

  void add(const Evaluation& e);
  /// Powers in units of the noise of the picture that shows least; that of the others is fitted.
  void find_noise();
  /// Of a picture so far from the focus.
  Foretold foretell(double from_focus, const OnTheWay& way) const;
  /// Of any picture, if the lens changed nothing.
  Foretold foretell_unchanged() const;
  void doubt(Foretold& told, double diameter_px, double misplaced_px, const RingRow& slope) const;
  void smear(Foretold& told, double from_focus, double smear) const;
  Cost fitted(std::vector<Foretold>& told, int rounds = kRounds) const;
  Cost summed(std::vector<Foretold>& told, const RingRow& object) const;
  void weigh(Foretold& told, const RingRow& object) const;
  static void gather(const Foretold& told, const RingRow& powers, RingRow& over, RingRow& under);
  static float noise_shown(const Foretold& told, const RingRow& powers, const RingRow& object);

  const DefocusLaw* law_;
  BlurModel model_;
  int rings_;
  double first_light_ = 0;
  std::vector<RingPicture> pictures_;
  RingRow freedom_{};  // [k] two over the degrees of freedom of the ring
  RingRow coarse_{};   // [k] unknown part of its power
};

/// The least cost near a place.
struct LeastCost {
  double position = 0;
  double cost = 0;
  double sigma = 0;  ///< By the cost's curvature.
};

/// By so many parabolas through three places, `step` apart at first.
LeastCost least_cost_near(const SpectralLikelihood& likelihood, double position, double step,
                          int rounds = 4);

}  // namespace fathom
