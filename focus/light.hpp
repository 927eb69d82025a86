// SPDX-License-Identifier: Apache-2.0
// Light that changes while the lens moves, taken out of a curve.
#pragma once

#include <vector>

#include "../engine/metric.hpp"
#include "curve.hpp"

namespace fathom {

/// By which power of the light a score of texture grows: 1, and 2 with `power`. 0 for an entropy,
/// whose spectrum is normalised.
double light_exponent(const MetricSpec& spec);

/// The score of the noise that the pictures carry, no more than the floor of the scores: that of the
/// least noisy picture, for texture as fine as pixels adds to what looks like it. 0 where the
/// pictures are not known. white_score: of noise of deviation 1 (noise.hpp).
double score_of_noise(const std::vector<Evaluation>& evaluations, double white_score,
                      double exponent);

/// The light of a picture over that of the first one, within what is believed of a lamp; 1 where one of
/// them is not known (0).
double lamp_ratio(double now, double first);

/// How a metric takes light, and noise.
struct LightResponse {
  double exponent = 0;     ///< light_exponent(); 0 leaves every score as it is.
  double white_score = 0;  ///< white_noise_score() of noise.hpp.
};

/// Scores as they would be in the light of the first evaluation: what stands above the pictures'
/// noise grows with the light to the exponent. Evaluations without a light stay as they are.
std::vector<Evaluation> in_one_light(std::vector<Evaluation> evaluations,
                                     const LightResponse& response);

/// The same in a light that may have changed by any amount, as an exposure does; and whether that is
/// more than in_one_light() believes of a lamp.
std::vector<Evaluation> in_one_exposure(std::vector<Evaluation> evaluations,
                                        const LightResponse& response);
bool is_beyond_a_lamp(const std::vector<Evaluation>& evaluations);

/// The same as if the floor were texture, too: what is left of the curve has no other cause than
/// what the lens does.
FocusCurve wholly_in_one_light(const FocusCurve& curve, double exponent);

}  // namespace fathom
