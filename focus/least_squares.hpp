// SPDX-License-Identifier: Apache-2.0
// What fits need of linear algebra. Eigen is compiled behind this header alone: it costs seconds a
// file.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace fathom {

/// A matrix of doubles, zero at first.
class Matrix {
 public:
  Matrix(std::size_t rows, std::size_t columns)
      : rows_(rows), columns_(columns), values_(rows * columns) {}

  std::size_t rows() const { return rows_; }
  std::size_t columns() const { return columns_; }
  double& operator()(std::size_t row, std::size_t column) { return values_[column * rows_ + row]; }
  double operator()(std::size_t row, std::size_t column) const {
    return values_[column * rows_ + row];
  }
  /// Column after column.
  std::span<const double> values() const { return values_; }

 private:
  std::size_t rows_, columns_;
  std::vector<double> values_;
};

/// What the squares are summed of, as functions of the parameters x.
struct ResidualModel {
  std::size_t count = 0;  ///< Of residuals; no fewer than parameters.
  std::function<void(std::span<const double> x, std::span<double> residuals)> residuals;
  /// Derivative of each residual (row) by each parameter (column).
  std::function<void(std::span<const double> x, Matrix& jacobian)> jacobian;
};

/// Parameters of the least sum of squares that a walk from `start` finds (Levenberg-Marquardt). It
/// ends when a step changes squares or parameters by less than `tolerance`, relative; 0 stands for
/// the root of the spacing of doubles. Parameters may come back infinite or NaN.
std::vector<double> minimize_squares(const ResidualModel& model, std::vector<double> start,
                                     double tolerance = 0);

/// The x for which rows x comes nearest to the values; nothing where a number is not finite or the
/// rows determine no x. values: one for each row.
std::optional<std::vector<double>> solve_squares(const Matrix& rows,
                                                 std::span<const double> values);

/// (J'J)^-1.
struct NormalInverse {
  Matrix matrix;
  /// Whether the columns of J differ by more than rounding; else the matrix means nothing.
  bool is_certain;
};
NormalInverse normal_inverse(const Matrix& jacobian);

}  // namespace fathom
