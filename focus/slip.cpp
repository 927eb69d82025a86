// SPDX-License-Identifier: Apache-2.0
#include "focus/slip.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace fathom {
namespace {

/// What the cells differ from their mean by, as parts of it: blur leaves that mean as it is.
std::vector<double> relief(const std::vector<std::uint32_t>& cells) {
  const double mean =
      std::accumulate(cells.begin(), cells.end(), 0.0) / static_cast<double>(cells.size());
  std::vector<double> parts(cells.size());
  std::transform(cells.begin(), cells.end(), parts.begin(),
                 [mean](std::uint32_t cell) { return cell / mean - 1; });
  return parts;
}

/// Sums over cells of products of the changes from the first picture: 1 to another, 2 to the last.
struct Changes {
  double s11 = 0, s12 = 0, s22 = 0;

  /// What is left of the squares if the last is `c` of the way from the first to another. All
  /// three have the same noise, so it is the distance from the line that counts, not that along an
  /// axis: the first picture's noise alone makes both changes alike.
  double left(double c) const { return (s22 - 2 * c * s12 + c * c * s11) / (2 * (c * c - c + 1)); }

  /// The c of the least left().
  double best() const {
    const double a = 2 * s12 - s11, half_b = s11 - s22,
                 root_of = half_b * half_b - a * (s22 - 2 * s12);
    if (a == 0) return half_b == 0 ? 0 : -(s22 - 2 * s12) / (2 * half_b);
    const double root = std::sqrt(std::max(0.0, root_of));
    const double one = (-half_b + root) / a, other = (-half_b - root) / a;
    return left(one) < left(other) ? one : other;
  }
};

Changes changes(const Evaluation& first, const Evaluation& other, const Evaluation& last) {
  const std::vector<double> a = relief(first.picture.cells), b = relief(other.picture.cells),
                            c = relief(last.picture.cells);
  Changes sums;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double one = b[i] - a[i], two = c[i] - a[i];
    sums.s11 += one * one;
    sums.s12 += one * two;
    sums.s22 += two * two;
  }
  return sums;
}

bool has_light(const std::vector<std::uint32_t>& cells) {
  return std::any_of(cells.begin(), cells.end(), [](std::uint32_t cell) { return cell > 0; });
}

}  // namespace

std::optional<Slip> slip_of(const Evaluation& first, const Evaluation& other,
                            const Evaluation& last) {
  constexpr std::size_t kFewest = 64;
  const std::size_t count = first.picture.cells.size();
  for (const Evaluation* e : {&first, &other, &last}) {
    if (e->picture.cells.size() != count || !has_light(e->picture.cells)) return std::nullopt;
  }
  if (count < kFewest) return std::nullopt;
  const Changes sums = changes(first, other, last);
  const double part = sums.best();
  const double noise = sums.left(part) / static_cast<double>(count - 2);  // of a cell, squared
  // A change as weak as the noise has a direction by chance, and so has any other.
  constexpr double kClear = 2;
  if (!(noise > 0) || sums.s11 / 2 < kClear * noise * static_cast<double>(count))
    return std::nullopt;
  return Slip{.part = part, .evidence = (sums.left(0) - sums.left(part)) / noise};
}

bool is_slipped(const Evaluation& first, std::span<const Evaluation> others,
                const Evaluation& last) {
  // Of 350 searches on a lens that stood where it said the most was 11 (fathom_honesty, undisturbed).
  constexpr double kEvidence = 20;
  return std::any_of(others.begin(), others.end(), [&](const Evaluation& other) {
    const auto slip = other.position != first.position ? slip_of(first, other, last) : std::nullopt;
    return slip && slip->evidence > kEvidence;
  });
}

}  // namespace fathom
