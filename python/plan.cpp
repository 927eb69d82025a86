// SPDX-License-Identifier: Apache-2.0
#include "python/plan.hpp"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <array>
#include <list>
#include <optional>
#include <span>
#include <vector>

#include "engine/one_thread.hpp"
#include "python/arrays.hpp"
#include "python/errors.hpp"
#include "python/given.hpp"
#include "python/scoring.hpp"

namespace fathom::python {
namespace {

using Values = py::array_t<double>;

/// A batch on its way, with all that the engine writes to or reads from.
struct Flight {
  std::uint64_t number = 0;
  Plan::Ticket ticket;
  std::optional<Pictures> picture;
  Frame frame;
  std::vector<Window> windows;
  py::object values;
};

bool is_room(py::handle out, std::span<const py::ssize_t> shape) {
  if (!py::isinstance<py::array_t<double, py::array::c_style>>(out)) return false;
  const auto array = py::reinterpret_borrow<py::array>(out);
  return array.writeable() &&
         std::equal(shape.begin(), shape.end(), array.shape(), array.shape() + array.ndim());
}

class StreamPlan {
 public:
  StreamPlan(py::handle metric, py::handle capacity, py::handle backend, py::handle threads)
      : spec_(MetricSpec::parse(given_text(metric, "metric"))),
        scorer_(open_scorer(spec_, wished_text(backend, "backend"),
                            wished_count(threads, "threads"), some_of(capacity))),
        plan_(scorer_->selection().device->plan(spec_, some_of(capacity))) {}
  StreamPlan(const StreamPlan&) = delete;
  StreamPlan& operator=(const StreamPlan&) = delete;
  ~StreamPlan() { land(); }

  /// Starts to score; the picture is held and must not be written to until wait().
  std::uint64_t submit(py::handle image, py::handle windows, py::handle out) {
    const OneThread::Inside inside(door_);
    Plan& plan = open_plan();
    std::list<Flight> fresh;
    if (spare_.empty()) spare_.emplace_back();
    fresh.splice(fresh.begin(), spare_, spare_.begin());
    Flight& flight = fresh.front();
    load(flight, image, windows, out);
    auto values = py::reinterpret_borrow<Values>(flight.values);
    const std::span<double> all(values.mutable_data(), static_cast<std::size_t>(values.size()));
    {
      const py::gil_scoped_release unlocked;
      flight.ticket = plan.submit(flight.frame, flight.windows, all);
    }
    flight.number = ++last_;
    flights_.splice(flights_.end(), fresh);
    return last_;
  }

  /// The values of a batch, once they are there. Each batch is waited for once.
  py::object wait(py::handle ticket) {
    const auto number = static_cast<std::uint64_t>(given_ticket(ticket));
    const OneThread::Inside inside(door_);
    Plan& plan = open_plan();
    for (auto flight = flights_.begin(); flight != flights_.end(); ++flight) {
      if (flight->number != number) continue;
      std::list<Flight> landing;
      landing.splice(landing.begin(), flights_, flight);
      wait_for(plan, landing.front().ticket);
      py::object values = std::move(landing.front().values);
      unload(landing.front());
      spare_.splice(spare_.end(), landing);
      return values;
    }
    refuse(fmt::format("ticket {} is of no batch in flight: it was waited for, or never given",
                       number));
  }

  /// Waits for all that is in flight and gives the device back.
  void close() {
    const OneThread::Inside inside(door_);
    land();
  }

  std::string metric() const { return spec_.text(); }
  std::size_t outputs() const { return spec_.outputs(); }
  std::size_t in_flight() const { return flights_.size(); }
  std::size_t capacity() { return open_plan().capacity(); }
  std::string device() {
    open_plan();
    return scorer_->selection().reason;
  }

 private:
  static std::size_t some_of(py::handle capacity) {
    const int count = given_count(capacity, "capacity");
    if (count < 1) refuse(fmt::format("capacity is {}; it is the most windows of one call", count));
    return static_cast<std::size_t>(count);
  }

  void land() {
    if (plan_) {
      const py::gil_scoped_release unlocked;
      plan_.reset();  // waits for its batches
      scorer_.reset();
    }
    flights_.clear();
    spare_.clear();
  }

  static long long given_ticket(py::handle ticket) {
    const long long number = PyLong_AsLongLong(ticket.ptr());
    if (PyErr_Occurred() == nullptr) return number;
    PyErr_Clear();
    refuse("ticket is none; it is what submit() returned");
  }

  static void wait_for(Plan& plan, Plan::Ticket ticket) {
    const py::gil_scoped_release unlocked;
    plan.wait(ticket);
  }

  Plan& open_plan() {
    if (!plan_) refuse("the plan is closed; make a new one");
    return *plan_;
  }

  void load(Flight& flight, py::handle image, py::handle windows, py::handle out) {
    flight.picture.emplace(image, "image");
    if (flight.picture->is_stack()) refuse("image is a stack; submit its pictures one by one");
    flight.frame = flight.picture->frame(0);
    flight.windows.clear();
    read_windows(windows, flight.frame.width_px(), flight.frame.height_px(), spec_.n,
                 flight.windows);
    if (flight.windows.size() > plan_->capacity()) {
      refuse(fmt::format("windows holds {}, and the plan's capacity is {}", flight.windows.size(),
                         plan_->capacity()));
    }
    flight.values = room(out, flight.windows.size());
  }

  /// `out`, which takes no memory, or a new array: (K,), or (K, rings).
  py::object room(py::handle out, std::size_t windows) const {
    const std::array<py::ssize_t, 2> axes = {static_cast<py::ssize_t>(windows), spec_.rings};
    const std::span shape(axes.data(), spec_.measure == Measure::rings ? 2 : 1);
    if (out.is_none()) return Values(std::vector<py::ssize_t>(shape.begin(), shape.end()));
    if (!is_room(out, shape)) {
      refuse(fmt::format("out must be a writeable C-contiguous float64 array of shape ({},{})",
                         windows, shape.size() > 1 ? fmt::format(" {}", shape[1]) : ""));
    }
    return py::reinterpret_borrow<py::object>(out);
  }

  static void unload(Flight& flight) {
    flight.frame = Frame();
    flight.picture.reset();
  }

  MetricSpec spec_;
  std::optional<Scorer> scorer_;  // of which the device is used
  std::unique_ptr<Plan> plan_;
  std::list<Flight> flights_;  // the oldest first
  std::list<Flight> spare_;    // with room for windows
  std::uint64_t last_ = 0;
  OneThread door_;
};

}  // namespace

void bind_plan(py::module_& module) {
  py::class_<StreamPlan>(module, "Plan")
      .def(py::init<py::handle, py::handle, py::handle, py::handle>())
      .def("submit", &StreamPlan::submit)
      .def("wait", &StreamPlan::wait)
      .def("close", &StreamPlan::close)
      .def_property_readonly("metric", &StreamPlan::metric)
      .def_property_readonly("outputs", &StreamPlan::outputs)
      .def_property_readonly("capacity", &StreamPlan::capacity)
      .def_property_readonly("in_flight", &StreamPlan::in_flight)
      .def_property_readonly("device", &StreamPlan::device);
}

}  // namespace fathom::python
