// SPDX-License-Identifier: Apache-2.0
#include "focus/resemblance.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>

#include "focus/focus.hpp"

namespace fathom {
namespace {

/// Detail is what a blur of `fine` pixels leaves and one of `coarse` takes away.
struct Scale {
  double fine, coarse;
};
constexpr Scale kScales[] = {{1, 4}, {2, 8}};

std::vector<float> gaussian(double sigma) {
  const int radius = static_cast<int>(std::ceil(4 * sigma));
  std::vector<float> kernel;
  for (int i = -radius; i <= radius; ++i)
    kernel.push_back(static_cast<float>(std::exp(-0.5 * i * i / (sigma * sigma))));
  const float sum = std::accumulate(kernel.begin(), kernel.end(), 0.0f);
  for (float& weight : kernel) weight /= sum;
  return kernel;
}

/// Blurs along rows, and turns the picture: twice is both axes. Edges are continued.
Patch blurred_rows(const Patch& patch, const std::vector<float>& kernel) {
  constexpr int kAtOnce = 16;
  using Part = Eigen::Array<float, kAtOnce, 1>;
  const int radius = static_cast<int>(kernel.size() / 2), n = patch.width;
  Patch turned{patch.height, n, std::vector<float>(patch.greys.size())};
  std::vector<float> line(static_cast<std::size_t>(n) + 2 * radius + kAtOnce);
  for (int y = 0; y < patch.height; ++y) {
    const float* const row = patch.greys.data() + static_cast<std::size_t>(y) * n;
    for (int x = -radius; x < n + radius; ++x) line[x + radius] = row[std::clamp(x, 0, n - 1)];
    for (int first = 0; first < n; first += kAtOnce) {
      Part sums = Part::Zero();
      for (std::size_t k = 0; k < kernel.size(); ++k)
        sums += kernel[k] * Eigen::Map<const Part>(line.data() + first + k);
      for (int x = first; x < std::min(first + kAtOnce, n); ++x)
        turned.greys[static_cast<std::size_t>(x) * patch.height + y] = sums[x - first];
    }
  }
  return turned;
}

Patch blurred(const Patch& patch, double sigma) {
  const auto kernel = gaussian(sigma);
  return blurred_rows(blurred_rows(patch, kernel), kernel);
}

Patch detail_of(const Patch& patch, const Scale& scale) {
  Patch detail = blurred(patch, scale.fine);
  const Patch coarse = blurred(patch, scale.coarse);
  for (std::size_t i = 0; i < detail.greys.size(); ++i) detail.greys[i] -= coarse.greys[i];
  return detail;
}

std::vector<float> squares_of(const Patch& patch) {
  std::vector<float> squares = patch.greys;
  for (float& value : squares) value *= value;
  return squares;
}

double sum_of(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

/// The part of its area that the energy would fill, were it even: (SUM e)^2 / (n SUM e^2), e the
/// energy round a pixel.
double evenness_of(const Patch& detail) {
  constexpr double kRound = 3;  // px
  const Patch energy = blurred({detail.width, detail.height, squares_of(detail)}, kRound);
  const double sum = sum_of(energy.greys), squares = sum_of(squares_of(energy));
  return squares > 0 ? sum * sum / (static_cast<double>(energy.greys.size()) * squares) : 1;
}

/// Sums over rectangles of squared detail.
class EnergyTable {
 public:
  explicit EnergyTable(const Patch& detail)
      : width_(detail.width + 1), sums_(static_cast<std::size_t>(width_) * (detail.height + 1)) {
    for (int y = 0; y < detail.height; ++y) {
      double row = 0;
      for (int x = 0; x < detail.width; ++x) {
        const double value = detail.greys[static_cast<std::size_t>(y) * detail.width + x];
        row += value * value;
        sums_[at(x + 1, y + 1)] = sums_[at(x + 1, y)] + row;
      }
    }
  }

  double of(int left, int top, int right, int bottom) const {
    return sums_[at(right, bottom)] - sums_[at(left, bottom)] - sums_[at(right, top)] +
           sums_[at(left, top)];
  }

 private:
  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * width_ + x; }

  int width_;
  std::vector<double> sums_;
};

/// So many shifts at once, for the sums of a whole row stay where they are added up.
constexpr int kShiftsAtOnce = 20;

/// Adds SUM greys(i) line(i + s) for s = 0, 1 ..
void add_products(std::span<const float> greys, const float* line, float* products) {
  using Part = Eigen::Array<float, kShiftsAtOnce, 1>;
  Part sums = Eigen::Map<const Part>(products);
  for (const float grey : greys) sums += grey * Eigen::Map<const Part>(line++);
  Eigen::Map<Part>{products} = sums;
}

/// SUM patch(px, py) other(x + px + dx, y + py) over the patch for
/// dx = -reach .. reach. What lies outside of the other picture adds nothing.
std::vector<float> products_of_row(const Patch& patch, const Patch& other, int x, int y,
                                   int reach) {
  const int shifts = 2 * reach + 1, n = patch.width;
  const int rounded = (shifts + kShiftsAtOnce - 1) / kShiftsAtOnce * kShiftsAtOnce;
  std::vector<float> products(rounded), line(static_cast<std::size_t>(n) + rounded);
  for (int py = 0; py < patch.height; ++py) {
    const int there = y + py;
    if (there < 0 || there >= other.height) continue;
    const float* const row = other.greys.data() + static_cast<std::size_t>(there) * other.width;
    for (int i = 0; i < n + shifts; ++i) {
      const int at = x - reach + i;
      line[i] = at >= 0 && at < other.width ? row[at] : 0;
    }
    const std::span greys(patch.greys.data() + static_cast<std::size_t>(py) * n,
                          static_cast<std::size_t>(n));
    for (int first = 0; first < shifts; first += kShiftsAtOnce)
      add_products(greys, line.data() + first, products.data() + first);
  }
  products.resize(shifts);
  return products;
}

/// How alike a pixel is to those up to kNear away: SUM f(x) f(x + shift) / SUM f^2, for half of all
/// shifts; the other half is the same.
std::vector<double> likeness_to_near(const Patch& detail) {
  constexpr int kNear = 8;
  std::vector<double> likeness;
  for (int dy = 0; dy <= kNear; ++dy) {
    const auto products = products_of_row(detail, detail, 0, dy, kNear);
    likeness.insert(likeness.end(), products.begin() + (dy == 0 ? kNear + 1 : 0), products.end());
  }
  const double energy = sum_of(squares_of(detail));
  for (double& value : likeness) value /= energy;
  return likeness;
}

/// So many pixels vary as one: of two independent pictures the correlation coefficient has the
/// variance of this over the pixels that overlap.
double pixels_in_one(const Patch& a, const Patch& b) {
  const auto one = likeness_to_near(a), other = likeness_to_near(b);
  return std::max(1.0, 1 + 2 * std::inner_product(one.begin(), one.end(), other.begin(), 0.0));
}

/// The detail of two pictures, to be laid over each other.
class Overlay {
 public:
  Overlay(Patch patch, Patch other, int x, int y)
      : patch_(std::move(patch)),
        other_(std::move(other)),
        x_(x),
        y_(y),
        energy_(patch_),
        other_energy_(other_),
        in_one_(pixels_in_one(patch_, other_)),
        evenness_(evenness_of(patch_)) {
    filled_ = std::min(evenness_, evenness_of(other_));
  }

  double evenness() const { return evenness_; }

  /// The most evidence of any shift.
  double evidence(int reach_px) const {
    double most = 0;
    for (int dy = -reach_px; dy <= reach_px; ++dy) {
      const auto products = products_of_row(patch_, other_, x_, y_ + dy, reach_px);
      for (int dx = -reach_px; dx <= reach_px; ++dx) {
        if (dx * dx + dy * dy <= reach_px * reach_px)
          most = std::max(most, evidence_at(dx, dy, products[dx + reach_px]));
      }
    }
    return most;
  }

 private:
  double evidence_at(int dx, int dy, double products) const {
    constexpr double kLeastOverlap = 0.3;
    const int right = x_ + dx, down = y_ + dy;
    const int left = std::max(0, -right), top = std::max(0, -down);
    const int end = std::min(patch_.width, other_.width - right);
    const int bottom = std::min(patch_.height, other_.height - down);
    if (end <= left || bottom <= top) return 0;
    const double area = static_cast<double>(end - left) * (bottom - top);
    if (area < kLeastOverlap * static_cast<double>(patch_.greys.size())) return 0;
    const double energies = energy_.of(left, top, end, bottom) *
                            other_energy_.of(left + right, top + down, end + right, bottom + down);
    if (!(energies > 0) || !(products > 0)) return 0;
    const double coefficient = std::min(0.9999, products / std::sqrt(energies));
    // Of all shifts as near as this one the best was taken.
    const double tried = 1 + std::numbers::pi * (dx * dx + dy * dy) / in_one_;
    const double independent = area / in_one_ * filled_;
    return -0.5 * independent * std::log(1 - coefficient * coefficient) - std::log(tried);
  }

  Patch patch_, other_;
  int x_, y_;
  EnergyTable energy_, other_energy_;
  double in_one_;    ///< Pixels that vary as one.
  double evenness_;  ///< Of the patch,
  double filled_;    ///< and the lower of both.
};

/// Whether the other picture has the very same pixels there.
bool is_copy(const Patch& patch, const Patch& other, int x, int y) {
  if (x < 0 || y < 0 || x + patch.width > other.width || y + patch.height > other.height)
    return false;
  for (int row = 0; row < patch.height; ++row) {
    const auto here = patch.greys.begin() + static_cast<std::ptrdiff_t>(row) * patch.width;
    const auto there = other.greys.begin() + static_cast<std::ptrdiff_t>(row + y) * other.width + x;
    if (!std::equal(here, here + patch.width, there)) return false;
  }
  return true;
}

bool is_flat(const Patch& patch) {
  const auto [least, most] = std::minmax_element(patch.greys.begin(), patch.greys.end());
  return patch.greys.empty() || *least == *most;
}

}  // namespace

std::vector<float> detail_energy(const Patch& patch) {
  return squares_of(detail_of(patch, kScales[0]));
}

std::optional<Resemblance> compare(const Patch& patch, const Patch& other, int x, int y,
                                   int reach_px) {
  if (is_flat(patch) || is_flat(other) || is_copy(patch, other, x, y)) return std::nullopt;
  Resemblance best{0, 1};
  for (const Scale& scale : kScales) {
    Overlay overlay(detail_of(patch, scale), detail_of(other, scale), x, y);
    best.evidence = std::max(best.evidence, overlay.evidence(reach_px));
    if (&scale == kScales) best.evenness = overlay.evenness();
    if (best.evidence >= kEvident) break;  // coarser detail need say nothing
  }
  return best;
}

void doubt_for_resemblance(Focus& focus, const std::optional<Resemblance>& resemblance) {
  constexpr double kHalf = 0.5;
  focus.resemblance = resemblance;
  const bool is_by_scores = focus.verdict.reason.why == Why::stands_out;
  if (!resemblance || !is_by_scores || resemblance->evidence >= kEvident) return;
  focus.verdict.confidence *= kHalf;
  if (resemblance->evenness <= kEven) return;
  focus.verdict.result = FocusResult::no_focus;
  focus.verdict.reason.why = Why::unshared;
  focus.verdict.confidence = 0;
}

}  // namespace fathom
