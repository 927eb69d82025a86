// SPDX-License-Identifier: Apache-2.0
#include "python/instrument.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "calibration/range.hpp"
#include "engine/error.hpp"
#include "python/arrays.hpp"
#include "python/errors.hpp"
#include "python/focus_values.hpp"
#include "python/focusing.hpp"
#include "python/terms.hpp"
#include "python/warning_values.hpp"
#include "python/watcher.hpp"
#include "session/ranging.hpp"
#include "session/session.hpp"
#include "words/calibration_words.hpp"

namespace fathom::python {
namespace {

/// Taken for the time of a run.
class Busy {
 public:
  explicit Busy(bool& is_busy) : is_busy_(is_busy) {
    if (is_busy) refuse("the rig measures already; one thread at a time uses a rig");
    is_busy_ = true;
  }
  Busy(const Busy&) = delete;
  Busy& operator=(const Busy&) = delete;
  ~Busy() { is_busy_ = false; }

 private:
  bool& is_busy_;
};

/// Keeps warnings for the result.
class WarningList final : public Observer {
 public:
  void warned(const Warning& warning) override { warnings_.push_back(warning); }
  /// With Python's lock.
  py::list list() const {
    py::list all;
    for (const Warning& warning : warnings_) all.append(dict_of(warning));
    return all;
  }

 private:
  std::vector<Warning> warnings_;
};

py::dict dict_of_run(const Run& run) {
  py::dict result = dict_of(*run.focus);
  result["journey"] = dict_of(journey_of(run));
  result["spectrum"] = py::cast(run.spectrum);
  return result;
}

/// What only the rig can tell of a request.
void require_request(Rig& rig, const FocusRequest& request) {
  require_part(rig.lens().info(), request.from, request.to);
  if (request.start) require_on_travel(rig.lens().info(), *request.start, "start");
  if (request.search == SearchMethod::spectral && !request.blur && !rig.blur() &&
      rig.camera().is_live()) {
    refuse(
        "search is 'spectral', which must know how the lens blurs; give blur= (px per unit of "
        "travel), or search with 'coarse'");
  }
}

/// A search, and the lens where it belongs afterwards.
void search(Rig& rig, const FocusRequest& request, bool stays, Observer& all) {
  require_request(rig, request);
  LensReturn put_back(rig.lens(), all);
  const Focus focus = *Session(rig).focus(request, all).focus;
  if (!stays || focus.result() != FocusResult::focused) return;
  rig.lens().move_to(rig.lens().nearest(focus.position()));
  put_back.release();
}

void refuse_other_unit(const Calibration& calibration, const std::string& unit) {
  const CalibrationConditions& made = calibration.conditions();
  if (!made.has_other_unit(unit)) return;
  refuse(fmt::format("calibration has positions in {}, this lens counts {}; calibrate this rig",
                     made.unit, unit));
}

/// A lens that says nothing of its blur has that of the calibration.
void use_blur(const Calibration& calibration, Rig& rig, FocusRequest& request) {
  if (!request.blur && rig.camera().is_live() && rig.has_spectra() && !rig.blur())
    request.blur = calibration.conditions().blur;
}

CalibrationConditions conditions_of(Rig& rig) {
  CalibrationConditions now;
  now.rig = rig.description();
  now.metric = rig.spec().text();
  now.window = rig.window();
  return now;
}

void add_all(py::list& warnings, const std::vector<CalibrationDoubt>& doubts) {
  for (const CalibrationDoubt& doubt : doubts) warnings.append(dict_of(doubt));
}

/// A distance only where most runs focused: runs that fail one after the other are no accident.
py::dict outcome_of(const RunFile& file, py::list& warnings) {
  py::list foci;
  for (const Run& run : file.runs) foci.append(dict_of_run(run));
  py::dict result(py::arg("foci") = foci, py::arg("distance_mm") = py::none(),
                  py::arg("journey") = dict_of(journey_of(file.runs)));
  const std::vector<Peak> peaks = focused_peaks(file.runs);
  if (2 * peaks.size() <= file.runs.size()) return result;
  const Ranged ranged = range_of(file, file.runs);
  const double position = mean_position(peaks);
  result["distance_mm"] = ranged.distance.mm;
  result["sigma_mm"] = ranged.distance.sigma_mm;
  result["position"] = position;
  result["spectra_apart"] = ranged.likeness.apart;
  result["other_object"] = ranged.likeness.other_object;
  result["unlikeness_sigma_mm"] = strange_mm(*file.calibration, ranged.likeness, position);
  add_all(warnings, doubts_of(*file.calibration, ranged.likeness, position));
  return result;
}

}  // namespace

Instrument::Instrument(RigOptions options, const Open& open) {
  options.shot.stop_requests = requests_of(stop_);
  const py::gil_scoped_release unlocked;
  rig_ = open(options);
}

Rig& Instrument::open_rig() {
  if (!rig_) refuse("the rig is closed; open it again");
  return *rig_;
}

/// Runs the body without Python's lock; a signal's exception comes before the library's.
template <class Body>
auto Instrument::measure(Body body) {
  const Busy busy(is_busy_);
  Rig& rig = open_rig();
  stop_->begin();
  try {
    const py::gil_scoped_release unlocked;
    return body(rig);
  } catch (const Error&) {
    stop_->rethrow();
    throw;
  }
}

double Instrument::position() {
  return measure([](Rig& rig) { return rig.lens().position(); });
}

double Instrument::move_to(double position) {
  return measure([=](Rig& rig) {
    require_on_travel(rig.lens().info(), position, "position");
    return arrive(rig.lens(), position).position;
  });
}

py::object Instrument::capture(std::optional<double> position) {
  const Frame frame = measure([=](Rig& rig) {
    if (position) require_on_travel(rig.lens().info(), *position, "position");
    const double here = position ? *position : rig.lens().nearest(rig.lens().position());
    return shoot(rig.camera(), rig.lens(), here, rig.options().shot).frame.clone();
  });
  return array_of(frame);
}

RunKeeper Instrument::keeper_of(const char* verb) {
  RunSetup setup = setup_of(open_rig());
  setup.verb = verb;
  return RunKeeper(std::move(setup));
}

py::dict Instrument::focus(const py::dict& wishes, bool stays, const Told& told) {
  const FocusRequest request = request_of(wishes);
  Watcher watcher(told.tell, told.wants_frames);
  WarningList warnings;
  const RunFile file = measure([&](Rig& rig) {
    RunKeeper keeper = keeper_of("focus");
    Observers all({&keeper, &warnings, &watcher});
    search(rig, request, stays, all);
    return std::move(keeper.file);
  });
  py::dict result = dict_of_run(file.runs.back());
  result["warnings"] = warnings.list();
  return result;
}

py::dict Instrument::sweep(std::optional<double> from, std::optional<double> to,
                           std::optional<double> step, const Told& told) {
  Watcher watcher(told.tell, told.wants_frames);
  WarningList warnings;
  if (step && !(*step > 0)) refuse(fmt::format("step is {}; it is above 0", *step));
  const Run run = measure([&](Rig& rig) {
    require_part(rig.lens().info(), from, to);
    Observers all({&warnings, &watcher});
    LensReturn put_back(rig.lens(), all);
    return Session(rig).sweep({from, to, step}, all);
  });
  py::dict result = curve_of(run.evaluations());
  result["warnings"] = warnings.list();
  return result;
}

py::dict Instrument::range(const Calibration& calibration, const py::dict& wishes, int repeat,
                           bool extrapolate, const Told& told) {
  if (repeat < 1) refuse(fmt::format("repeat is {}; it is 1 or more", repeat));
  FocusRequest request = request_of(wishes);
  request.returns = true;
  Watcher watcher(told.tell, told.wants_frames);
  WarningList warnings;
  CalibrationConditions now;
  const RunFile file = measure([&](Rig& rig) {
    now = conditions_of(rig);
    refuse_other_unit(calibration, rig.lens().info().unit);
    use_blur(calibration, rig, request);
    require_request(rig, request);
    RunKeeper keeper = keeper_of("range");
    keeper.file.calibration = calibration;
    keeper.file.extrapolate = extrapolate;
    Observers all({&keeper, &warnings, &watcher});
    LensReturn put_back(rig.lens(), all);
    for (int i = 0; i < repeat; ++i) Session(rig).focus(request, all);
    return std::move(keeper.file);
  });
  py::list said = warnings.list();
  add_all(said, doubts_of(calibration, now, kTerms));
  py::dict result = outcome_of(file, said);
  result["warnings"] = said;
  return result;
}

py::dict Instrument::about() {
  Rig& rig = open_rig();
  const LensInfo lens = rig.lens().info();
  const Window window = rig.window();
  return py::dict(py::arg("description") = rig.description(), py::arg("metric") = rig.spec().text(),
                  py::arg("window") = py::make_tuple(window.x, window.y, window.n),
                  py::arg("unit") = lens.unit, py::arg("lowest") = lens.lowest,
                  py::arg("highest") = lens.highest, py::arg("resolution") = lens.resolution,
                  py::arg("stops") = lens.stops, py::arg("backend") = rig.selection().backend);
}

void Instrument::place_target(double distance_mm) {
  measure([=](Rig& rig) {
    if (rig.stage() == nullptr)
      throw Error(ErrorCode::unsupported, "this rig cannot place its target; move it yourself");
    try {
      rig.stage()->place_at(distance_mm);
    } catch (const Error& error) {
      throw Error(error.code(), fmt::format("distance_mm is {}: {}", distance_mm, error.what()));
    }
  });
}

std::optional<double> Instrument::target_mm() {
  Rig& rig = open_rig();
  if (rig.stage() == nullptr) return std::nullopt;
  return rig.stage()->distance_mm();
}

void Instrument::close() {
  const Busy busy(is_busy_);
  let_go();
}

void Instrument::let_go() {
  const py::gil_scoped_release unlocked;
  rig_.reset();
}

}  // namespace fathom::python
