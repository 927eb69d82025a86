// SPDX-License-Identifier: Apache-2.0
// The curves between lens position and distance (thesis T14): one file each in calibration/models/,
// and one line each in calibration/CMakeLists.txt.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fathom {

/// How the points of a calibration are made of order 1, so that a fit neither over- nor underflows:
///   t = (distance - distance_origin) / distance_scale, or the same of logarithms, or of reciprocals,
///       which is (1 / distance_origin - 1 / distance) / distance_scale;
///   u = (position - position_origin) / position_scale.
struct CalibrationScales {
  double distance_origin = 0;  ///< mm.
  double distance_scale = 1;   ///< mm; a logarithm's, where t is of logarithms; or 1/mm.
  double position_origin = 0;  ///< In the lens's unit; 0 where the zero of positions counts.
  double position_scale = 1;   ///< In the lens's unit.
};

/// In what t is linear: distances as they are, or what the formula makes straight lines of.
enum class DistanceRuler { distances, logarithms, reciprocals };

/// A formula with its parameters b, as a set of functions of scaled coordinates. All of them are
/// given but `objection`, which may be null.
struct CalibrationFormula {
  static constexpr int kMostParameters = 3;
  using Vector = std::array<double, kMostParameters>;  ///< Only the formula's own count.

  /// Each curve through a point is linear in some x: row . x = value.
  struct LinearRow {
    Vector row;
    double value;
  };
  /// A parameter of the textbook formula, and how it changes with each b.
  struct Natural {
    std::string name;
    double value;
    Vector gradient;
  };

  const char* name;     ///< As a user writes it.
  const char* summary;  ///< For the help, in brackets: "distance = b0 + b1 / position".
  int parameters;       ///< How many b there are, and so how many distances are needed.
  DistanceRuler ruler;  ///< In what t is linear.
  bool takes_any_zero;  ///< Whether positions may count from anywhere, below 0 too.
  double (*u_at)(const Vector& b, double t);  ///< NaN where no position focuses this distance.
  /// Infinity at or beyond the focus on infinity, NaN where the formula has no distance.
  double (*t_at)(const Vector& b, double u);
  double (*dt_du)(const Vector& b, double u);
  Vector (*du_db)(const Vector& b, double t);
  LinearRow (*linear_row)(double t, double u);
  /// The b of the x that enough points together have, nearly where they are more than enough.
  Vector (*from_linear)(const Vector& x);
  std::vector<Natural> (*natural)(const Vector& b, const CalibrationScales& scales);
  /// The formula with the values of its natural parameters in it.
  std::string (*equation)(std::span<const double> natural);
  /// Why no lens has this curve; null for one that a lens may have.
  const char* (*objection)(const Vector& b);
};

/// One of the formulas, as a value.
class CalibrationModel {
 public:
  /// Those that code asks for by name; another needs no line here.
  static const CalibrationModel inverse, power, dioptre, thin_lens;

  /// The formula must outlive the model.
  constexpr explicit CalibrationModel(const CalibrationFormula& formula) : formula_(&formula) {}

  const CalibrationFormula& formula() const { return *formula_; }

  bool operator==(const CalibrationModel&) const = default;

 private:
  const CalibrationFormula* formula_;
};

/// All of them, the one with the fewest parameters first.
std::span<const CalibrationModel> calibration_models();

const char* to_string(CalibrationModel model) noexcept;
/// Throws Error(bad_argument), listing the models, for another name.
CalibrationModel parse_calibration_model(
    std::string_view name, std::span<const CalibrationModel> models = calibration_models());
/// How many distances and points a model needs at least.
int parameter_count(CalibrationModel model);

/// The table that calibration/CMakeLists.txt makes.
std::span<const CalibrationFormula* const> calibration_formulas();

}  // namespace fathom
