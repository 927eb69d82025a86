// SPDX-License-Identifier: Apache-2.0
// How one picture lies on another one of the same scene: Gauss and Newton's method on the squares of
// what differs (Lucas and Kanade 1981).
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <optional>
#include <vector>

#include "plane.hpp"

namespace fathom::depth {

/// A point x + iy about the middle goes to turn x + shift; turn is scale times a rotation.
struct Motion {
  std::complex<double> turn = 1, shift = 0;
};

/// A picture without its low frequencies (light) and its high ones (which focus changes).
struct Band {
  explicit Band(Plane its_values);

  Plane values;
  /// Coefficients of the cubic B-splines that go through the values (Unser 1999). Between four values
  /// alone a small movement would look smaller than it is.
  Plane splines;
};

/// Compares two bands. A blur that is the same on all sides moves nothing, but makes texture fainter, more so
/// from place to place, and a picture that fades to one side looks as if it moved. So each part of the
/// picture has a gain, and how that changes along x and y, of its own. Only places of much texture, in
/// every part, are looked at.
class BandMatch {
 public:
  /// unknowns: 1 for growth about the middle, 4 for growth, turn and shift. Both bands are kept by
  /// reference.
  BandMatch(const Band& before, const Band& after, int unknowns);

  /// Improves a motion, in cells of this band. Several steps, until they are small.
  Motion improved(Motion motion) const;

  /// How sure it is by how much one band grew over the other, as a part of it: sigma.
  double growth_sigma(const Motion& motion) const;

  /// The part of the squares that the other band does not explain, 0 to 1.
  double unlike(const Motion& motion) const;
  /// Whether a motion explains more than another one does, by so much that noise cannot: the F test
  /// of its unknowns.
  bool is_beyond_chance(const Motion& motion, const Motion& than) const;

 private:
  static constexpr int kUnknowns = 4;
  using Unknowns = std::array<double, kUnknowns>;
  /// A place of `before` that is looked at: its value, and how that changes with each unknown.
  struct Place {
    float x, y, value;
    std::array<float, kUnknowns> slopes;
  };
  /// What a part's gain may do: be, and change along x and y.
  static constexpr int kGains = 3;
  using Gains = std::array<double, kGains>;
  /// Sums over a part, of its values a after, its slopes s, and its values before times what a gain
  /// may do, b.
  struct Sums {
    double aa = 0, count = 0;
    Gains ba{};
    Unknowns sa{};
    std::array<Gains, kGains> bb{};
    std::array<Gains, kUnknowns> bs{};
    std::array<Unknowns, kUnknowns> ss{};
  };
  /// A part of the picture: places [begin, end) within a rectangle, and their sums without those of a.
  struct Part {
    std::size_t begin, end;
    float left, top, right, bottom;
    Sums sums;
  };
  struct Solved;
  /// Normal equations of growth, turn and both shifts.
  struct Equations {
    std::array<Unknowns, kUnknowns> square{};
    Unknowns right{};
  };

  void choose_places();
  void add_part(int left, int top, int right, int bottom);
  void choose_steepest(std::size_t begin);
  void add_slopes(Place& place) const;
  /// What a gain may do to this place of a part.
  static Gains gains_of(const Place& place, const Part& part);
  static void add_before(const Place& place, const Part& part, Sums& sums);
  static void add_after(const Place& place, const Part& part, float after, Sums& sums);
  Sums sums_of(const Part& part, const Motion& motion) const;
  /// Of parts that are alike.
  std::vector<Solved> solved_at(const Motion& motion) const;
  Equations equations_of(const std::vector<Solved>& parts) const;
  /// For the unknowns that are asked for; nothing where they are not determined.
  static std::optional<Unknowns> solve(Equations e, int unknowns);
  bool is_there(const Motion& motion, float x, float y) const;
  /// Cells from the middle to a corner: growth and turn are counted in cells there, so that all
  /// unknowns are alike.
  double reach() const { return std::abs(middle_); }

  const Plane& before_;
  const Plane& after_;  ///< Its splines.
  int unknowns_;
  std::complex<double> middle_;
  int rim_;
  std::vector<Place> places_;
  std::vector<Part> parts_;
};

}  // namespace fathom::depth
