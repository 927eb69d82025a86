// SPDX-License-Identifier: Apache-2.0
// What the pictures of a search say together by their spectra, and whether that is to be believed.
#pragma once

#include <span>

#include "spectral.hpp"

namespace fathom {

struct FocusLimits;

/// A fit that is no chance, fits, and has no rival.
bool is_sure(const SpectralFit& fit);

/// How sure such a fit is, 0..1: by how far evidence and lead are above what they must be, and by
/// how well the law describes the pictures.
double confidence_of(const SpectralFit& fit);

/// What the pictures within the law's reach of `here` say together: the fit of the window that is
/// scored where that is sure, else of the largest one.
SpectralFit fit_all(std::span<const Evaluation> evaluations, double here,
                    const FocusLimits& limits);

}  // namespace fathom
