// SPDX-License-Identifier: Apache-2.0
// A focus curve as a picture: what was evaluated, and what a search made of it.
#include <fmt/format.h>

#include <algorithm>

#include "engine/error.hpp"
#include "tools/fathom/palette.hpp"
#include "tools/fathom/plot.hpp"

namespace fathom::cli {
namespace {

constexpr const char* kFit = palette::kBlue;
constexpr const char* kAnswer = palette::kVermilion;
constexpr const char* kSecond = palette::kGreen;
constexpr const char* kJoined = palette::kJoined;
constexpr const char* kEvaluated = palette::kInk;

bool has_shape(const Peak& peak) {
  return (peak.shape == PeakShape::gaussian || peak.shape == PeakShape::lorentzian) &&
         peak.half_width > 0;
}

/// The fitted shape round its top, as far as the curve goes.
Curve fitted(const Peak& peak, double floor, const FocusCurve& curve, const std::string& title) {
  constexpr int kSamples = 160;
  constexpr double kReach = 1.5;  // half widths: farther down nothing was fitted
  Curve fit{.style = CurveStyle::line, .title = title, .points = {}, .colour = kFit};
  if (!has_shape(peak)) return fit;
  const double low = std::max(curve.front().position, peak.position - kReach * peak.half_width);
  const double high = std::min(curve.back().position, peak.position + kReach * peak.half_width);
  for (int i = 0; i <= kSamples; ++i) {
    const double position = low + (high - low) * i / kSamples;
    const double part = height_at(peak.shape, (position - peak.position) / peak.half_width);
    fit.points.push_back({position, floor + (peak.score - floor) * part});
  }
  return fit;
}

Curve ring(const Peak& peak, const char* colour, const std::string& title) {
  return {.style = CurveStyle::mark,
          .title = title,
          .points = {{peak.position, peak.score}},
          .colour = colour};
}

/// Where the answer lies with 1 sigma, from the bottom to the top.
Curve sigma_band(const Peak& peak) {
  const double half = peak.score / 2;
  return {.style = CurveStyle::band,
          .title = "",
          .points = {{peak.position - peak.sigma, half, half},
                     {peak.position + peak.sigma, half, half}},
          .colour = palette::kVermilionBand};
}

void add_answer(std::vector<Curve>& curves, const Focus& focus, const FocusCurve& curve) {
  const bool is_focus = focus.result() == FocusResult::focused;
  if (focus.result() == FocusResult::no_focus) return;  // A ring would say that there is one.
  if (is_focus) curves.insert(curves.begin(), sigma_band(focus.peak));
  curves.push_back(fitted(focus.peak, focus.floor, curve,
                          fmt::format("fitted {}", to_string(focus.peak.shape))));
  curves.push_back(ring(focus.peak, kAnswer,
                        fmt::format("{} at {:.6g} +- {:.2g}", to_string(focus.result()),
                                    focus.peak.position, focus.peak.sigma)));
  for (std::size_t i = 1; i < focus.lobes.size(); ++i) {
    const Peak& lobe = focus.lobes[i];
    curves.push_back(fitted(lobe, focus.floor, curve, ""));
    curves.push_back(ring(lobe, kSecond, fmt::format("another peak: {:.6g}", lobe.position)));
  }
}

/// The title, and that there is no focus where there is none.
std::string title_of(const std::string& title, const Focus* focus) {
  const bool is_told = focus != nullptr && focus->result() != FocusResult::focused;
  return is_told ? fmt::format("{}: {}", title, to_string(focus->result())) : title;
}

std::vector<Curve> curves_of(const FocusCurve& curve, const Focus* focus) {
  Curve evaluated{
      .style = CurveStyle::points, .title = "evaluated", .points = {}, .colour = kEvaluated};
  for (const Evaluation& e : curve.evaluations()) evaluated.points.push_back({e.position, e.score});
  Curve joined = evaluated;
  joined.style = CurveStyle::line;
  joined.title.clear();
  joined.colour = kJoined;
  std::vector<Curve> curves{joined};
  if (focus != nullptr) {
    add_answer(curves, *focus, curve);
  } else {
    const Evaluation& top = curve.top();
    curves.push_back({.style = CurveStyle::mark,
                      .title = fmt::format("highest score: {:.6g}", top.position),
                      .points = {{top.position, top.score}},
                      .colour = kAnswer});
  }
  curves.push_back(evaluated);
  return curves;
}

}  // namespace

void write_focus_plot(const std::filesystem::path& path, std::span<const Evaluation> evaluations,
                      const PlotLabels& labels, const Focus* focus) {
  if (evaluations.empty()) throw Error(ErrorCode::bad_argument, "there is nothing to plot");
  const FocusCurve curve({evaluations.begin(), evaluations.end()});
  PlotLabels titled = labels;
  titled.title = title_of(labels.title, focus);
  try {
    write_curves(path, curves_of(curve, focus), titled);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::unavailable) throw;
    throw Error(ErrorCode::unavailable,
                fmt::format("{}; --plot - draws in the terminal without it", error.what()));
  }
}

}  // namespace fathom::cli
