// SPDX-License-Identifier: Apache-2.0
#include "python/devices.hpp"

#include <utility>
#include <vector>

#include "backends/backends.hpp"

namespace fathom::python {
namespace {

namespace py = pybind11;

/// Every device of every backend; drivers are asked without Python's lock.
std::vector<std::pair<const char*, DeviceInfo>> all_devices() {
  const py::gil_scoped_release unlocked;
  std::vector<std::pair<const char*, DeviceInfo>> all;
  for (const Backend* backend : all_backends()) {
    for (const DeviceInfo& device : backend->devices()) all.emplace_back(backend->name(), device);
  }
  return all;
}

}  // namespace

void bind_devices(py::module_& module) {
  module.def("devices", [] {
    py::list list;
    for (const auto& [backend, device] : all_devices()) {
      list.append(py::dict(py::arg("backend") = backend, py::arg("name") = device.name,
                           py::arg("kind") = to_string(device.kind),
                           py::arg("details") = device.details));
    }
    return list;
  });
}

}  // namespace fathom::python
