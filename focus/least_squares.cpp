// SPDX-License-Identifier: Apache-2.0
#include "focus/least_squares.hpp"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <unsupported/Eigen/NonLinearOptimization>

namespace fathom {
namespace {

Eigen::MatrixXd to_eigen(const Matrix& matrix) {
  return Eigen::Map<const Eigen::MatrixXd>(matrix.values().data(),
                                           static_cast<Eigen::Index>(matrix.rows()),
                                           static_cast<Eigen::Index>(matrix.columns()));
}

Matrix from_eigen(const Eigen::MatrixXd& matrix) {
  Matrix copy(static_cast<std::size_t>(matrix.rows()), static_cast<std::size_t>(matrix.cols()));
  for (std::size_t j = 0; j < copy.columns(); ++j) {
    for (std::size_t i = 0; i < copy.rows(); ++i)
      copy(i, j) = matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
  }
  return copy;
}

std::span<const double> span_of(const Eigen::VectorXd& vector) {
  return {vector.data(), static_cast<std::size_t>(vector.size())};
}

/// What Eigen's Levenberg-Marquardt asks for.
class Functor {
 public:
  Functor(const ResidualModel& model, std::size_t parameters)
      : model_(model), jacobian_(model.count, parameters) {}

  int inputs() const { return static_cast<int>(jacobian_.columns()); }
  int values() const { return static_cast<int>(model_.count); }

  int operator()(const Eigen::VectorXd& x, Eigen::VectorXd& residuals) {
    model_.residuals(span_of(x), {residuals.data(), model_.count});
    return 0;
  }
  int df(const Eigen::VectorXd& x, Eigen::MatrixXd& jacobian) {
    model_.jacobian(span_of(x), jacobian_);
    jacobian = to_eigen(jacobian_);
    return 0;
  }

 private:
  const ResidualModel& model_;
  Matrix jacobian_;
};

}  // namespace

std::vector<double> minimize_squares(const ResidualModel& model, std::vector<double> start,
                                     double tolerance) {
  Functor functor(model, start.size());
  Eigen::LevenbergMarquardt<Functor> solver(functor);
  if (tolerance > 0) solver.parameters.ftol = solver.parameters.xtol = tolerance;
  Eigen::VectorXd x =
      Eigen::Map<const Eigen::VectorXd>(start.data(), static_cast<Eigen::Index>(start.size()));
  solver.minimize(x);
  std::copy(x.begin(), x.end(), start.begin());
  return start;
}

std::optional<std::vector<double>> solve_squares(const Matrix& rows,
                                                 std::span<const double> values) {
  const Eigen::MatrixXd a = to_eigen(rows);
  const Eigen::VectorXd b =
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  if (!a.allFinite() || !b.allFinite()) return std::nullopt;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver(a);
  if (solver.rank() < a.cols()) return std::nullopt;
  const Eigen::VectorXd x = solver.solve(b);
  return std::vector<double>(x.begin(), x.end());
}

NormalInverse normal_inverse(const Matrix& jacobian) {
  const Eigen::MatrixXd j = to_eigen(jacobian);
  const Eigen::MatrixXd normal = j.transpose() * j;
  const bool is_certain = Eigen::FullPivLU<Eigen::MatrixXd>(normal).isInvertible();
  return {from_eigen(normal.inverse()), is_certain};
}

}  // namespace fathom
