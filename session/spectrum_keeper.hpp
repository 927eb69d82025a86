// SPDX-License-Identifier: Apache-2.0
// The spectrum of the object, in the sharpest picture that a search came by.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "../engine/frame.hpp"
#include "../engine/scorer.hpp"

namespace fathom {

/// Whatever the metric of the search is, spectra are of one and the same, so that any two compare.
class SpectrumKeeper {
 public:
  /// window: of the search. One that is too small for rings is never looked at.
  explicit SpectrumKeeper(const Window& window);

  /// Another search begins.
  void begin();
  /// A picture of it, with its score, which counts once it is kept. Throws as Scorer::score.
  void see(const Frame& frame, double score);
  /// The picture that was seen last was of a lens at rest.
  void keep();
  /// [k] mean mass in each of kSpectrumRings rings; empty where nothing was seen.
  const std::vector<double>& spectrum() const { return spectrum_; }

 private:
  Window window_;
  std::unique_ptr<Scorer> scorer_;  // made for the first picture; null where there is none
  double best_ = 0, seen_ = 0;
  std::vector<double> spectrum_, seen_spectrum_;
};

}  // namespace fathom
