// SPDX-License-Identifier: Apache-2.0
#include "focus/spectral_likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "focus/light.hpp"

namespace fathom {
namespace {

/// What the model does not know of a picture, beside noise. Parts of the power that it foretells:
constexpr float kUnknownPower = 0.03F;  ///< of every ring,
constexpr float kUnknownCoarse = 1.0F;  ///< over the squared cycles a window: shading, which blur
                                        ///< carries in and out,
constexpr float kUnknownFar = 1.0F;  ///< where the blur is a quarter of the window, growing as its
                                     ///< square: there light from outside takes part;
constexpr float kUnknownFloor = 1e-3F;   ///< and of the power in focus.
constexpr float kUnknownBlurPx = 0.15F;  ///< Of the diameter of the blur,
constexpr float kUnknownBlur = 0.03F;    ///< and a part of it.

/// What a ring that is not there scatters: it weighs nothing.
constexpr float kUnknownRing = 1e30F;

/// A way that adds so little blur within an exposure changes no ring by a hundredth.
constexpr double kUnseenSmearPx = 0.25;

float mean_of(std::span<const float> powers, std::span<const float> counts) {
  double sum = 0, count = 0;
  for (std::size_t k = 0; k < powers.size(); ++k) {
    sum += static_cast<double>(powers[k]) * counts[k];
    count += counts[k];
  }
  return static_cast<float>(count > 0 ? sum / count : 0);
}

/// The noise that the finest third of the rings shows, texture in it included.
float finest_power(std::span<const float> powers, std::span<const float> counts) {
  const std::size_t first = powers.size() - powers.size() / 3;
  return mean_of(powers.subspan(first), counts.subspan(first));
}

}  // namespace

const RingPowers* rings_in(const PictureFacts& picture, int side) {
  for (const RingPowers& rings : picture.rings) {
    if (rings.side == side) return &rings;
  }
  return nullptr;
}

/// What one picture should look like.
struct SpectralLikelihood::Foretold {
  RingRow squared{}, unknown{}, unknown_blur{}, weight{};
  float noise = 1;
};

SpectralLikelihood::SpectralLikelihood(std::span<const Evaluation> evaluations, int side,
                                       const BlurModel& model)
    : law_(&DefocusLaw::of(side, model.shape)), model_(model), rings_(law_->rings()) {
  freedom_.fill(kUnknownRing);
  for (int k = 0; k < rings_; ++k) {
    freedom_[k] = 2 / kRingFreedom / law_->counts()[k];
    const float cycles =
        (static_cast<float>(k) + 0.5F) * static_cast<float>(side) / 2 / static_cast<float>(rings_);
    coarse_[k] = kUnknownCoarse / (cycles * cycles);
  }
  for (const Evaluation& e : evaluations) add(e);
  find_noise();
}

double SpectralLikelihood::freedom() const {
  return std::max(1.0, static_cast<double>(size() - 1) * rings_ - static_cast<double>(size()));
}

SpectralLikelihood SpectralLikelihood::with(const BlurModel& model) const {
  SpectralLikelihood other = *this;
  other.model_ = model;
  other.law_ = &DefocusLaw::of(side(), model.shape);
  return other;
}

void SpectralLikelihood::add(const Evaluation& e) {
  const RingPowers* const rings = rings_in(e.picture, law_->side());
  if (rings == nullptr || static_cast<int>(rings->powers.size()) != rings_) return;
  RingPicture picture{.position = e.position, .way = e.on_the_way.value_or(OnTheWay{})};
  std::copy(rings->powers.begin(), rings->powers.end(), picture.powers.begin());
  if (first_light_ == 0) first_light_ = e.picture.light;
  const auto light = static_cast<float>(lamp_ratio(e.picture.light, first_light_));
  for (float& power : picture.powers) power /= light * light;
  pictures_.push_back(picture);
}

void SpectralLikelihood::find_noise() {
  float least = std::numeric_limits<float>::max();
  for (const RingPicture& picture : pictures_)
    least = std::min(least,
                     finest_power({picture.powers.data(), law_->counts().size()}, law_->counts()));
  // What rounding to whole grey levels leaves is the least noise there is.
  const float rounding = static_cast<float>(law_->white_power() / 12);
  const float unit = std::max(pictures_.empty() ? 0 : least, rounding);
  for (RingPicture& picture : pictures_) {
    for (float& power : picture.powers) power /= unit;
  }
}

// Loops over rings go on to the end of a row, so many as compilers know beforehand and turn into
// vectors. A ring that is not there has no power, of which nothing is known.

/// The weight of each ring of a picture: one over the variance of its power.
void SpectralLikelihood::weigh(Foretold& told, const RingRow& object) const {
  const float noise = told.noise;
  for (int k = 0; k < kMostRingsFitted; ++k) {
    const float signal = object[k] * told.squared[k];
    const float scatter = (noise * noise + 2 * noise * signal) * freedom_[k];
    const float variance =
        scatter + told.unknown[k] * signal * signal + object[k] * object[k] * told.unknown_blur[k];
    told.weight[k] = 1 / variance;
  }
}

/// Adds to the sums of the least squares for the object's powers.
void SpectralLikelihood::gather(const Foretold& told, const RingRow& powers, RingRow& over,
                                RingRow& under) {
  for (int k = 0; k < kMostRingsFitted; ++k) {
    const float weighted = told.weight[k] * told.squared[k];
    over[k] += weighted * (powers[k] - told.noise);
    under[k] += weighted * told.squared[k];
  }
}

namespace {

/// In several parts at once, which compilers turn into vectors.
constexpr int kAtOnce = 4;
static_assert(kMostRingsFitted % kAtOnce == 0);

float sum_of(RingRow row) {
  for (int first = kAtOnce; first < kMostRingsFitted; first += kAtOnce) {
    for (int part = 0; part < kAtOnce; ++part) row[part] += row[first + part];
  }
  return row[0] + row[1] + row[2] + row[3];
}

/// ln of the product of all of a row.
double log_of_product(const RingRow& factors) {
  double products[kAtOnce] = {1, 1, 1, 1};  // of few enough factors to be a number
  for (int first = 0; first < kMostRingsFitted; first += kAtOnce) {
    for (int part = 0; part < kAtOnce; ++part) products[part] *= factors[first + part];
  }
  double sum = 0;
  for (const double product : products) sum += std::log(product);
  return sum;
}

}  // namespace

/// The noise that the picture itself shows, were the object so: no less than rounding leaves.
float SpectralLikelihood::noise_shown(const Foretold& told, const RingRow& powers,
                                      const RingRow& object) {
  RingRow lacking;
  for (int k = 0; k < kMostRingsFitted; ++k)
    lacking[k] = told.weight[k] * (powers[k] - object[k] * told.squared[k]);
  return std::clamp(sum_of(lacking) / sum_of(told.weight), 0.3F, 30.0F);
}

SpectralLikelihood::Foretold SpectralLikelihood::foretell(double from_focus,
                                                          const OnTheWay& way) const {
  Foretold told;
  RingRow slope{};
  const double diameter_px = model_.diameter_px(from_focus);
  const auto count = static_cast<std::size_t>(rings_);
  law_->transfer(diameter_px, {told.squared.data(), count}, {slope.data(), count});
  if (way.smear * model_.px_per_unit > kUnseenSmearPx) smear(told, from_focus, way.smear);
  const double misplaced_px =
      way.sigma > 0 ? model_.diameter_px(std::abs(from_focus) + way.sigma) - diameter_px : 0;
  doubt(told, diameter_px, misplaced_px, slope);
  return told;
}

SpectralLikelihood::Foretold SpectralLikelihood::foretell_unchanged() const {
  Foretold told;
  told.squared.fill(1);
  doubt(told, 0, 0, {});
  return told;
}

/// The lens passes its way at one pace: the mean of the amplitudes by Gauss and Legendre.
void SpectralLikelihood::smear(Foretold& told, double from_focus, double smear) const {
  constexpr double kPlaces[] = {-0.9061798459386640, -0.5384693101056831, 0, 0.5384693101056831,
                                0.9061798459386640};
  constexpr double kWeights[] = {0.1184634425280945, 0.2393143352496832, 0.2844444444444444,
                                 0.2393143352496832, 0.1184634425280945};
  double diameters[std::size(kPlaces)];
  for (std::size_t i = 0; i < std::size(kPlaces); ++i)
    diameters[i] = model_.diameter_px(from_focus + smear / 2 * kPlaces[i]);
  law_->transfer_of_mean(diameters, kWeights,
                         {told.squared.data(), static_cast<std::size_t>(rings_)});
}

/// What the model does not know of such a picture. misplaced_px: how much other its blur is where the
/// lens stood as far aside as is not known.
void SpectralLikelihood::doubt(Foretold& told, double diameter_px, double misplaced_px,
                               const RingRow& slope) const {
  const auto diameter = static_cast<float>(diameter_px);
  const float far = diameter / (static_cast<float>(law_->side()) / 4);
  const float blur =
      std::hypot(kUnknownBlurPx + kUnknownBlur * diameter, static_cast<float>(misplaced_px));
  for (int k = 0; k < rings_; ++k) {
    const float part = kUnknownPower + kUnknownFar * far * far + coarse_[k];
    told.unknown[k] = part * part;
    const float absolute = slope[k] * blur;
    told.unknown_blur[k] = absolute * absolute + kUnknownFloor * kUnknownFloor;
  }
}

SpectralLikelihood::Cost SpectralLikelihood::summed(std::vector<Foretold>& told,
                                                    const RingRow& object) const {
  RingRow under{}, squares{}, known{};
  Cost cost;
  for (std::size_t i = 0; i < size(); ++i) {
    Foretold& one = told[i];
    weigh(one, object);
    const RingRow& powers = pictures_[i].powers;
    for (int k = 0; k < kMostRingsFitted; ++k) {
      const float rest = powers[k] - one.noise - object[k] * one.squared[k];
      squares[k] += rest * rest * one.weight[k];
      under[k] += one.weight[k] * one.squared[k] * one.squared[k];
    }
    std::fill(one.weight.begin() + rings_, one.weight.end(), 1.0F);
    cost.total -= log_of_product(one.weight);
  }
  for (int k = 0; k < rings_; ++k) cost.chi_squared += squares[k];
  // How well the pictures know the object's powers, which are integrated out: a ring that one picture
  // alone shows is foretold by any focus, and a sharp claim about it is worth nothing.
  for (int k = 0; k < kMostRingsFitted; ++k) known[k] = 1 + object[k] * object[k] * under[k];
  cost.total += cost.chi_squared + log_of_product(known);
  return cost;
}

/// The object's powers and the pictures' noises by alternating weighted least squares.
SpectralLikelihood::Cost SpectralLikelihood::fitted(std::vector<Foretold>& told, int rounds) const {
  RingRow object{};
  for (int round = 0; round <= rounds; ++round) {
    RingRow over{}, under{};
    for (std::size_t i = 0; i < size(); ++i) {
      if (round > 0) {
        weigh(told[i], object);
      } else {
        told[i].weight.fill(1);
      }
      gather(told[i], pictures_[i].powers, over, under);
      // From the first round's object, which is rough; the later ones leave it where it is.
      if (round == 1 || round == 2)
        told[i].noise = noise_shown(told[i], pictures_[i].powers, object);
    }
    for (int k = 0; k < kMostRingsFitted; ++k)
      object[k] = std::max(0.0F, over[k] / (under[k] + 1e-30F));
  }
  return summed(told, object);
}

SpectralLikelihood::Cost SpectralLikelihood::at(double focus, int rounds) const {
  std::vector<Foretold> told;
  told.reserve(size());
  for (const RingPicture& picture : pictures_)
    told.push_back(foretell(picture.position - focus, picture.way));
  return fitted(told, rounds);
}

SpectralLikelihood::Cost SpectralLikelihood::unchanged() const {
  std::vector<Foretold> told(size(), foretell_unchanged());
  const Cost alike = fitted(told);
  // Noise that grows from picture to picture must not pass for power of the object: the other place
  // to begin from is what each picture's finest rings show.
  for (std::size_t i = 0; i < size(); ++i) {
    told[i] = foretell_unchanged();
    told[i].noise =
        finest_power({pictures_[i].powers.data(), law_->counts().size()}, law_->counts());
  }
  const Cost noisy = fitted(told);
  return noisy.total < alike.total ? noisy : alike;
}

LeastCost least_cost_near(const SpectralLikelihood& likelihood, double position, double step,
                          int rounds) {
  LeastCost found{position, likelihood.at(position).total, step};
  for (int round = 0; round < rounds; ++round) {
    const double low = likelihood.at(found.position - step).total;
    const double high = likelihood.at(found.position + step).total;
    const double bend = low - 2 * found.cost + high;
    if (!(bend > 0)) {
      step /= 2;
      continue;
    }
    found.sigma = step * std::sqrt(2 / bend);
    const double shift = std::clamp((low - high) / (2 * bend), -1.0, 1.0) * step;
    const double there = likelihood.at(found.position + shift).total;
    if (there <= found.cost) {
      found.position += shift;
      found.cost = there;
    }
    step = std::clamp(2 * found.sigma, step / 8, step / 2);
  }
  return found;
}

}  // namespace fathom
