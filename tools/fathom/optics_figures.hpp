// SPDX-License-Identifier: Apache-2.0
// The thesis' figures 3, 4 and 14, for any lens.
#pragma once

#include <filesystem>

#include "engine/optics.hpp"

namespace fathom::cli {

/// Writes three SVG files into a folder, which is made if it is missing:
/// figure-3-depth-of-field.svg (depth of field against distance, for this aperture and its
/// neighbours), figure-4-mtf.svg (contrast against frequency, out of focus by n/pi wavelengths) and
/// figure-14-object-distance.svg (the distance in focus against the image distance). They are drawn
/// round an object at this distance, which may be infinite. Throws as write_curves.
void write_optics_figures(const std::filesystem::path& folder, const Optics& optics,
                          double object_mm, double wavelength_nm);

}  // namespace fathom::cli
