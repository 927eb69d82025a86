// SPDX-License-Identifier: Apache-2.0
// The search by spectra: from where the lens stands a few pictures tell the side and the place of
// the focus; the lens goes there, passes it once, and stops.
#pragma once

#include "search.hpp"
#include "spectral_fits.hpp"

namespace fathom {

struct FocusLimits;

/// How a search by spectra ended.
enum class SpectralEnd {
  found,             ///< The law of defocus holds, and the peak was passed.
  no_spectra,        ///< The pictures came without ring powers of the same window.
  nothing_changes,   ///< Moving the lens changes nothing beyond noise.
  does_not_defocus,  ///< The pictures change, but not as blur by this model makes them.
  beyond_travel,     ///< The focus seems to lie beyond what may be searched.
  lost,              ///< Pictures contradict each other, or the looks were used up.
};
inline constexpr SpectralEnd kSpectralEnds[] = {
    SpectralEnd::found,           SpectralEnd::no_spectra,
    SpectralEnd::nothing_changes, SpectralEnd::does_not_defocus,
    SpectralEnd::beyond_travel,   SpectralEnd::lost};

/// "found", "no-spectra" and so on: the names above with hyphens.
const char* to_string(SpectralEnd end) noexcept;

/// Evaluates from limits.start on, as few positions as tell the focus. limits.blur must be there.
/// Where it ends without a focus another search must go on.
SpectralEnd spectral_search(SearchTrace& trace, const FocusLimits& limits);

}  // namespace fathom
