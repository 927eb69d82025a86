// SPDX-License-Identifier: Apache-2.0
#include "serve/procedures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <exception>
#include <system_error>

#include "calibration/range.hpp"
#include "engine/error.hpp"
#include "engine/file.hpp"
#include "serve/aim_step.hpp"
#include "serve/calibrating_step.hpp"
#include "serve/depth_step.hpp"
#include "session/capture_folder.hpp"
#include "session/lens_blur.hpp"
#include "session/ranging.hpp"
#include "session/run_keeper.hpp"
#include "session/run_store.hpp"
#include "session/session.hpp"
#include "words/calibration_words.hpp"

namespace fathom::serve {
namespace {

constexpr std::uintmax_t kLargestCalibration = 64 << 20;

FocusRequest request_of(const Work& work, bool returns) {
  FocusRequest request = FocusRequest::within(work.order.from, work.order.to);
  request.search = work.search;
  request.returns = returns;
  return request;
}

RunSetup setup_for(const Work& work, Rig& rig) {
  RunSetup setup = setup_of(rig);
  setup.verb = to_string(work.order.kind);
  setup.command = fmt::format("fathom serve --rig {}: {} with metric {} in window {}", work.rig.rig,
                              setup.verb, rig.spec().text(), to_string(rig.window()));
  setup.created = utc_now();
  return setup;
}

/// Where the program keeps what it learns too, so that each knows what the other has learned.
LensBlur blur_for(const Work& work, Rig& rig, const FocusRequest& request,
                  const Calibration* calibration = nullptr) {
  const auto noted = [&publisher = work.publisher](const BlurNote& note) {
    if (note.news == BlurNews::not_read || note.news == BlurNews::not_kept)
      publisher.warn("the lens's blur: " + note.text);
  };
  return {rig, request, {.store = BlurStore(work.folder / "blur"), .noted = noted}, calibration};
}

Focus search(Rig& rig, LensBlur& blur, RunKeeper& keeper, Observer& all) {
  Focus focus = *Session(rig).focus(blur.request(), all).focus;
  blur.learn(keeper.file.runs.back());
  return focus;
}

void find_focus(const Work& work, Rig& rig, RunKeeper& keeper, Observer& all, Outcome& outcome) {
  LensReturn put_back(rig.lens(), all);
  LensBlur blur = blur_for(work, rig, request_of(work, false));
  outcome.focus = search(rig, blur, keeper, all);
  if (outcome.focus->result() != FocusResult::focused) return;
  rig.lens().move_to(rig.lens().nearest(outcome.focus->position()));
  put_back.release();
}

void sweep(const Work& work, Rig& rig, RunKeeper& keeper, Observer& all, Outcome& outcome) {
  LensReturn put_back(rig.lens(), all);
  const Run run = Session(rig).sweep(
      {.from = work.order.from, .to = work.order.to, .step = work.order.step}, all);
  FocusRequest none;
  none.search = SearchMethod::full;
  blur_for(work, rig, none).learn(keeper.file.runs.back());
  outcome.best = best_of(run.evaluations());
  outcome.words = fmt::format("highest score {:.6g} at {:g} {}", outcome.best->score,
                              outcome.best->position, rig.lens().info().unit);
}

void tell_doubts(const std::vector<CalibrationDoubt>& doubts, Publisher& publisher) {
  for (const CalibrationDoubt& doubt : doubts) publisher.warn(doubt.text);
}

void find_range(const Work& work, Rig& rig, RunKeeper& keeper, Observer& all, Outcome& outcome) {
  const Calibration& calibration =
      keeper.file.calibration.emplace(calibration_for(work, rig.lens().info().unit));
  tell_doubts(doubts_of(calibration, conditions_of(keeper.file.setup), page_terms()),
              work.publisher);
  LensReturn put_back(rig.lens(), all);
  LensBlur blur = blur_for(work, rig, request_of(work, true), &calibration);
  outcome.focus = search(rig, blur, keeper, all);
  if (outcome.focus->result() != FocusResult::focused) return;
  const Ranged ranged = range_of(keeper.file, keeper.file.runs);
  tell_doubts(doubts_of(calibration, ranged.likeness, outcome.focus->position()), work.publisher);
  keeper.file.distance = outcome.distance = ranged.distance;
}

void take_here(const Work& work, Rig& rig, CaptureFolder& folder) {
  const Arrival here = rig.lens().move_to(rig.lens().nearest(rig.lens().position()));
  for (int i = 0; i < work.order.frames; ++i)
    folder.add(take_frame(rig.camera(), here.settled_ns, work.rig.shot), here.position);
}

void capture(const Work& work, Rig& rig, Observer& all, Outcome& outcome) {
  const auto name = std::filesystem::path("captures") / work.order.name;
  CaptureFolder folder(work.folder / name);
  const LensInfo lens = rig.lens().info();
  folder.describe(lens.unit, lens.coarse_spacing);
  outcome.folder = name;
  if (work.order.from || work.order.to || work.order.step) {
    LensReturn put_back(rig.lens(), all);
    CapturedPictures pictures(folder);
    Observers both({&pictures, &all});
    Session(rig).sweep({.from = work.order.from, .to = work.order.to, .step = work.order.step},
                       both);
  } else {
    take_here(work, rig, folder);
  }
  outcome.words = fmt::format("{} pictures in {}", folder.size(), name.string());
}

void measure(Work& work, Rig& rig, RunKeeper& keeper, Observer& all, Outcome& outcome) {
  switch (work.order.kind) {
    case Activity::aim:
      return find_window(work, rig, all, outcome);
    case Activity::focus:
      return find_focus(work, rig, keeper, all, outcome);
    case Activity::sweep:
      return sweep(work, rig, keeper, all, outcome);
    case Activity::range:
      return find_range(work, rig, keeper, all, outcome);
    case Activity::calibrate: {
      LensBlur blur = blur_for(work, rig, request_of(work, true));
      return calibrate(work, rig, blur, keeper, all, outcome);
    }
    case Activity::depth:
      return map_depth(work, rig, all, outcome);
    case Activity::capture:
      return capture(work, rig, all, outcome);
    case Activity::live:
    case Activity::stopping:
      break;
  }
  throw Error(ErrorCode::bad_argument, "nothing that can be measured");
}

/// A map and a capture leave files of their own, an aim leaves a window.
bool leaves_run(Activity kind) {
  return kind != Activity::depth && kind != Activity::capture && kind != Activity::aim;
}

bool has_measurements(const RunFile& file) {
  return std::ranges::any_of(file.runs, [](const Run& run) { return !run.measurements.empty(); });
}

void keep(const Work& work, const RunFile& file, Outcome& outcome) {
  if (!leaves_run(work.order.kind) || !has_measurements(file)) return;
  try {
    outcome.run = keep_run(runs_folder(work.folder), file).stem();
  } catch (const std::exception& error) {
    work.publisher.warn(fmt::format("the run is lost: {}", error.what()));
  }
}

void note_failure(Ending& ending, const std::exception& problem) {
  const auto* const error = dynamic_cast<const Error*>(&problem);
  ending.failure = error != nullptr ? error->code() : ErrorCode::unavailable;
  ending.outcome.error = problem.what();
}

}  // namespace

Ending carry_out(Work& work) {
  Ending ending;
  try {
    Rig rig(work.rig, work.hardware.lend());
    RunKeeper keeper(setup_for(work, rig));
    Telling telling(work.publisher, work.id, work.order.kind, work.began_ns);
    Observers all({&keeper, &telling});
    try {
      measure(work, rig, keeper, all, ending.outcome);
    } catch (const std::exception& problem) {
      note_failure(ending, problem);
      keeper.file.error = problem.what();
    }
    keep(work, keeper.file, ending.outcome);
  } catch (const std::exception& problem) {
    note_failure(ending, problem);
  }
  return ending;
}

std::filesystem::path runs_folder(const std::filesystem::path& folder) { return folder / "runs"; }

void require_plain_name(const std::string& name) {
  constexpr std::size_t kLongest = 64;
  const bool is_plain = std::ranges::all_of(name, [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '.' || c == '-' || c == '_';
  });
  if (is_plain && !name.empty() && name.size() <= kLongest && name[0] != '.') return;
  throw Error(ErrorCode::bad_argument,
              "a name has 1 to 64 letters, digits, dots, hyphens and underscores, and begins with "
              "no dot");
}

std::filesystem::path calibration_file(const std::filesystem::path& folder,
                                       const std::string& name) {
  require_plain_name(name);
  return folder / "calibrations" / (name + ".json");
}

Calibration calibration_for(const Work& work, const std::string& unit) {
  const auto file = calibration_file(work.folder, work.order.calibration);
  Calibration calibration =
      Calibration::parse(read_file(file, kLargestCalibration), work.order.calibration);
  require_unit(calibration, unit);
  return calibration;
}

std::vector<std::string> calibrations_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "calibrations", ignored)) {
    if (entry.path().extension() == ".json" && entry.is_regular_file(ignored))
      names.push_back(entry.path().stem());
  }
  std::ranges::sort(names);
  return names;
}

}  // namespace fathom::serve
