// SPDX-License-Identifier: Apache-2.0
// From scores to a peak.
#pragma once

#include <pybind11/pybind11.h>

#include <optional>

#include "engine/travel.hpp"
#include "focus/focus.hpp"

namespace fathom::python {

void bind_focusing(pybind11::module_& module);

/// What a user may say of a search: from, to, search, peak, tolerance, frames, start, blur (px for
/// each unit of travel).
/// What is None or absent follows from the lens. Throws TypeError for another key.
FocusRequest request_of(const pybind11::dict& wishes);

/// Throws Error(out_of_bounds), naming the argument, for a position beyond the travel.
void require_on_travel(const LensInfo& lens, double position, const char* name);
/// The same for the ends of a part of it, from_ and to; Error(bad_argument) for a part upside down.
void require_part(const LensInfo& lens, const std::optional<double>& from,
                  const std::optional<double>& to);

}  // namespace fathom::python
