// SPDX-License-Identifier: Apache-2.0
// fathom.score and fathom.spectrum: a call each, with the scorers kept for the next one.
#pragma once

#include <pybind11/pybind11.h>

#include <optional>
#include <string>

#include "engine/scorer.hpp"

namespace fathom::python {

namespace py = pybind11;

void bind_scoring(py::module_& module);

/// Selects and opens a device and makes the plan, without Python's lock. backend: None or a text.
/// threads: None, or from 1 on. Throws as Scorer, Error(bad_argument), naming threads.
Scorer open_scorer(const MetricSpec& spec, const std::optional<std::string>& backend,
                   std::optional<int> threads, std::size_t batch);

/// threads= as the engine takes it; 0 for None.
int thread_count(std::optional<int> threads);

}  // namespace fathom::python
