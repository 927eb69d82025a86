// SPDX-License-Identifier: Apache-2.0
// What spectra make of a verdict that scores came to.
#pragma once

#include "focus.hpp"

namespace fathom {

/// Of a search that looked at spectra; another is left as it is. One that found and passed a focus is
/// believed where scores drown in noise, and refines their answer where they do not. One that went back
/// to its start and found another blur there than in `first` has lost steps: no focus;
/// where there is no first one, nothing tells that.
///
/// A peak of scores that is narrower than the lens can make one is noise; the law alone is believed.
void heed_spectra(Focus& focus, const Evaluation* first, const FocusLimits& limits);

/// Whether it is noise alone that keeps scores from a focus: spectra look deeper into it.
bool is_for_noise(Why why);

/// The same with a sigma that knows of objects which obey the law badly: a round one holds several
/// depths, and what that makes of the rings pulls all of them one way. A search, which goes on looking
/// while sigma is large, would gain nothing from it.
SpectralFit doubted(SpectralFit fit);

/// Whether a lens that blurs so could make a peak of this half width: less blur halves no frequency
/// that a picture has. Yes where the width is 0, which means that nobody fitted it.
bool could_make(double half_width, const BlurModel& model);

}  // namespace fathom
