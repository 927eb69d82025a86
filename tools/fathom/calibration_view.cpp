// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/calibration_view.hpp"

#include <cmath>

#include "tools/fathom/console.hpp"

namespace fathom::cli {
namespace {

std::string interval_text(const DistanceInterval& interval) {
  return fmt::format("{:.1f} .. {:.1f}", interval.low_mm, interval.high_mm);
}

std::size_t count_left_out(const Calibration& calibration) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < calibration.points().size(); ++i) {
    count += calibration.left_out(i) ? 1 : 0;
  }
  return count;
}

/// "8 points", or "7 of 8 points" where one is left out.
std::string points_text(const Calibration& calibration) {
  const std::size_t all = calibration.points().size(), out = count_left_out(calibration);
  return out > 0 ? fmt::format("{} of {} points", all - out, all) : fmt::format("{} points", all);
}

/// "135.2 +- 1.1", or without what nothing is known of.
std::string with_sigma(const CalibrationParameter& parameter) {
  if (std::isnan(parameter.sigma)) return fmt::format("{:.6g}", parameter.value);
  return fmt::format("{:.6g} +- {:.2g}", parameter.value, parameter.sigma);
}

void print_points(const Calibration& calibration) {
  print_line(fmt::format("\n{:>12}  {:>12}  {:>10}  {:>12}  {}", "position", "distance mm",
                         "residual", "residual mm", "95 % interval mm"));
  const auto steps = calibration.position_residuals(), mm = calibration.residuals_mm();
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const CalibrationPoint& point = calibration.points()[i];
    const std::string interval =
        calibration.freedom() > 0 ? interval_text(calibration.interval(point.position)) : "unknown";
    print_line(fmt::format("{:>12g}  {:>12g}  {:>+10.2f}  {:>+12.2f}  {}{}", point.position,
                           point.distance_mm, steps[i], mm[i], interval,
                           calibration.left_out(i) ? "  left out" : ""));
  }
}

void print_fit_line(const Calibration& calibration) {
  JsonLine line;
  line.add("model", to_string(calibration.model()));
  for (const CalibrationParameter& parameter : calibration.parameters()) {
    line.add(parameter.name, parameter.value).add("sigma_" + parameter.name, parameter.sigma);
  }
  print_line(line.add("r_squared", calibration.r_squared())
                 .add("points", calibration.points().size())
                 .add("left_out", count_left_out(calibration))
                 .add("position_scatter", calibration.position_scatter())
                 .text());
}

bool distance_rises(const Calibration& calibration) {
  return calibration.model() == CalibrationModel::inverse && calibration.parameters()[1].value < 0;
}

void note_outliers(const Calibration& calibration) {
  const auto residuals = calibration.position_residuals();
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (!calibration.left_out(i)) continue;
    const CalibrationPoint& point = calibration.points()[i];
    note(fmt::format("left out as an outlier: {:g} mm at position {:g}, {:.3g} {} off",
                     point.distance_mm, point.position, std::abs(residuals[i]),
                     unit_of(calibration)));
  }
}

void note_focal_length(const Calibration& calibration) {
  const CalibrationParameter f = calibration.parameters()[0];
  if (f.value > 0 && !(f.sigma > f.value / 2)) return;
  note(
      fmt::format("these distances do not determine the focal length, {} mm: the curve holds "
                  "between them, its parameters mean little; measure nearer and farther",
                  with_sigma(f)));
}

}  // namespace

std::string unit_of(const Calibration& calibration) {
  const std::string& unit = calibration.conditions().unit;
  return unit.empty() ? "units" : unit;
}

namespace {

std::string reason_of(const ModelChoice& choice) {
  if (choice.model == choice.best) return "it predicts left-out distances best";
  return fmt::format("it has fewer parameters than {}, whose lead is no more than chance",
                     to_string(choice.best));
}

}  // namespace

void print_choice(const ModelChoice& choice, bool json) {
  if (json) {
    JsonLine line;
    for (const ModelTrial& trial : choice.trials) {
      line.add(fmt::format("cv_error_{}", to_string(trial.model)), trial.error);
    }
    return print_line(
        line.add("model", to_string(choice.model)).add("reason", reason_of(choice)).text());
  }
  print_line(fmt::format("\n{:<10}  {:>10}  {:>10}", "model", "CV error", "R^2"));
  for (const ModelTrial& trial : choice.trials) {
    const std::string error =
        std::isfinite(trial.error) ? fmt::format("{:.3f} %", 100 * trial.error) : "none";
    const std::string fit =
        std::isfinite(trial.r_squared) ? fmt::format("{:.6f}", trial.r_squared) : "-";
    print_line(fmt::format("{:<10}  {:>10}  {:>10}{}{}", to_string(trial.model), error, fit,
                           trial.problem.empty() ? "" : "  ", trial.problem));
  }
  print_line(fmt::format("{}: {} (CV: relative error of each distance by a fit without it)",
                         to_string(choice.model), reason_of(choice)));
}

void print_calibration(const Calibration& calibration, bool json) {
  if (json) return print_fit_line(calibration);
  print_points(calibration);
  print_line(
      fmt::format("\n{}, R^2 = {:.6f}, {}; one position scatters by {:.2g} about the "
                  "curve",
                  calibration.equation(), calibration.r_squared(), points_text(calibration),
                  calibration.position_scatter()));
  std::string parameters;
  for (const CalibrationParameter& parameter : calibration.parameters()) {
    parameters += fmt::format("{}{} = {}", parameters.empty() ? "" : ", ", parameter.name,
                              with_sigma(parameter));
  }
  print_line(parameters + " (1 sigma)");
}

void note_doubts(const Calibration& calibration) {
  note_outliers(calibration);
  if (calibration.r_squared() < kPoorRSquared || distance_rises(calibration)) {
    note(fmt::format(
        "this is a poor calibration (R^2 = {:.3f}{}); look at the residuals before using it",
        calibration.r_squared(),
        distance_rises(calibration) ? ", distance rises with position: try --model thin-lens"
                                    : ""));
  }
  if (calibration.freedom() < 1) {
    note(
        "as many points as parameters leave nothing to judge the fit by: its distances will claim "
        "too small a sigma");
  } else if (calibration.model() == CalibrationModel::thin_lens) {
    note_focal_length(calibration);
  }
}

}  // namespace fathom::cli
