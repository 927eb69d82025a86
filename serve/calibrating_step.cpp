// SPDX-License-Identifier: Apache-2.0
#include "serve/calibrating_step.hpp"

#include <fmt/format.h>

#include <cmath>

#include "calibration/choice.hpp"
#include "engine/error.hpp"
#include "engine/file.hpp"
#include "session/calibrating.hpp"
#include "session/ranging.hpp"
#include "session/session.hpp"
#include "words/verdict_words.hpp"

namespace fathom::serve {
namespace {

CalibrationModel model_for(const Work& work, const RunFile& file) {
  if (work.order.model != "auto") return parse_calibration_model(work.order.model);
  return choose_calibration_model(calibration_points(file.runs)).model;
}

/// The curve so far; empty while the points determine none.
std::string fit_so_far(const Work& work, const RunFile& file) {
  try {
    return fit_json(fit_calibration(file, model_for(work, file)), "");
  } catch (const Error&) {
    return "";
  }
}

void show(const Work& work, const RunFile& file) {
  const std::string fit = fit_so_far(work, file);
  work.publisher.change([&](State& state) {
    CalibrationView& view = *state.calibration;
    view.points.clear();
    for (const CalibrationPoint& point : calibration_points(file.runs))
      view.points.push_back({point.distance_mm, point.position, point.sigma});
    view.fit = fit;
  });
}

void require_distance(double distance_mm) {
  if (distance_mm > 0 && std::isfinite(distance_mm)) return;
  throw Error(ErrorCode::bad_argument, fmt::format("{} mm is not a distance", distance_mm));
}

void measure_at(const Work& work, Rig& rig, LensBlur& blur, double distance_mm, RunKeeper& keeper,
                Observer& all) {
  require_distance(distance_mm);
  if (rig.stage() != nullptr) rig.stage()->place_at(distance_mm);
  keeper.target_at(distance_mm);
  work.publisher.change(
      [&](State& state) { state.calibration->distances_mm.push_back(distance_mm); });
  const Focus focus = *Session(rig).focus(blur.request(), all).focus;
  blur.learn(keeper.file.runs.back());
  if (focus.result() == FocusResult::focused) return;
  work.publisher.warn(fmt::format("no focus at {:g} mm, which is left out: {}", distance_mm,
                                  words_for(focus.verdict, page_terms())));
}

/// A distance that the rig cannot have is said, and another one asked for.
void try_at(const Work& work, Rig& rig, LensBlur& blur, double distance_mm, RunKeeper& keeper,
            Observer& all) {
  try {
    measure_at(work, rig, blur, distance_mm, keeper, all);
  } catch (const Error& error) {
    const bool is_wish =
        error.code() == ErrorCode::bad_argument || error.code() == ErrorCode::out_of_bounds;
    if (!is_wish) throw;
    work.publisher.warn(error.what());
  }
}

}  // namespace

void calibrate(Work& work, Rig& rig, LensBlur& blur, RunKeeper& keeper, Observer& all,
               Outcome& outcome) {
  LensReturn put_back(rig.lens(), all);
  show(work, keeper.file);
  for (NextStep step = work.next_step(); step.distance_mm; step = work.next_step()) {
    try_at(work, rig, blur, *step.distance_mm, keeper, all);
    show(work, keeper.file);
  }
  RunFile& file = keeper.file;
  file.calibration = fit_calibration(file, model_for(work, file));
  write_file(calibration_file(work.folder, work.order.name), file.calibration->json());
  const std::string fit = fit_json(*file.calibration, work.order.name);
  const auto names = calibrations_in(work.folder);
  work.publisher.change([&](State& state) {
    state.calibration->fit = fit;
    state.calibrations = names;
  });
  outcome.words = fmt::format("{}, from {} points; kept as {}", file.calibration->equation(),
                              file.calibration->points().size(), work.order.name);
  outcome.folder = "calibrations";
}

}  // namespace fathom::serve
