// SPDX-License-Identifier: Apache-2.0
// How the program shows a calibration: tables, warnings and two plots.
#pragma once

#include <string>

#include "calibration/calibration.hpp"
#include "calibration/choice.hpp"

namespace fathom::cli {

/// The unit of positions, "units" where nobody wrote it down.
std::string unit_of(const Calibration& calibration);

/// What --model auto tried and why one won, on stdout as a table or, with json, one line.
void print_choice(const ModelChoice& choice, bool json);

/// The points with residuals and 95 % intervals, the curve, its parameters; with json one line of
/// the latter.
void print_calibration(const Calibration& calibration, bool json);

/// Says on stderr what deserves doubt: outliers, a poor fit, a focal length that nothing
/// determines.
void note_doubts(const Calibration& calibration);

/// What --plot asks for: "-" draws the residuals in the terminal (on stderr where stdout carries
/// JSON), a path writes both panels as SVG through gnuplot, empty does nothing. Throws as
/// write_curves.
void plot_calibration(const std::string& where, const Calibration& calibration, bool json);

}  // namespace fathom::cli
