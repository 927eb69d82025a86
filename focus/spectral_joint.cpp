// SPDX-License-Identifier: Apache-2.0
#include "focus/spectral_joint.hpp"

#include "focus/blur_fit.hpp"
#include "focus/searches.hpp"

namespace fathom {
namespace {

/// More pictures tell a blur no better.
constexpr std::size_t kMostLooks = 60;

std::vector<double> thinned(const std::vector<double>& positions) {
  const std::size_t stride = (positions.size() + kMostLooks - 1) / kMostLooks;
  std::vector<double> chosen;
  for (std::size_t i = 0; i < positions.size(); i += stride) chosen.push_back(positions[i]);
  return chosen;
}

}  // namespace

Focus joint_search(SearchTrace& trace, const FocusLimits& limits, const Scatter& scatter) {
  evaluate_all(trace, thinned(limits.coarse.positions));
  const bool has_rings = ring_sides(trace.evaluations()).largest != 0;
  // Of few pictures a focus may have but one on its farther side.
  const auto fit = fit_blur(trace.evaluations(), {.focus = {}, .a_side = 1});
  FocusLimits known = limits;
  if (fit) {
    known.blur = fit->model;
    const SpectralFit place = fit_all(trace.evaluations(), fit->position, known);
    if (is_sure(place)) return conclude_search(trace, known, scatter, SpectralEnd::found);
  }
  search_of(SearchMethod::coarse).run(trace, limits, scatter);
  return conclude_search(trace, limits, scatter,
                         has_rings ? SpectralEnd::does_not_defocus : SpectralEnd::no_spectra);
}

}  // namespace fathom
