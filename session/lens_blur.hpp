// SPDX-License-Identifier: Apache-2.0
// Where a measurement knows the lens's blur from, and what it learns of it for the next one.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "../calibration/calibration.hpp"
#include "../focus/focus.hpp"
#include "blur_store.hpp"

namespace fathom {

/// What there is to say of a lens's blur.
enum class BlurNews {
  not_read,        ///< What was learned before cannot be read.
  of_calibration,  ///< The calibration's is used.
  of_before,       ///< What was learned before is used.
  learned,         ///< It was learned, and is kept.
  learned_once,    ///< It was learned, and is not kept.
  not_kept,        ///< It could not be kept.
};

struct BlurNote {
  BlurNews news = BlurNews::not_read;
  double px_per_unit = 0;  ///< Of the lens; 0 for what could not be read or kept.
  std::string text;        ///< The day on which it was learned, or what went wrong.
};

/// What a user says counts most, then what the lens says, the calibration, and what was learned.
class LensBlur {
 public:
  struct Keeping {
    std::optional<BlurStore> store;              ///< Where it is kept; nowhere without one.
    std::function<void(const BlurNote&)> noted;  ///< Told of what is used, learned, or wrong.
  };

  /// Reads what was learned of this rig. calibration: may be null. The rig must outlive this.
  LensBlur(Rig& rig, const FocusRequest& request, Keeping keeping,
           const Calibration* calibration = nullptr);

  /// The request with the blur that is known by now.
  const FocusRequest& request() const { return request_; }

  /// Keeps what a run tells, where that is more than was known; a live lens that says its blur
  /// itself needs none of it.
  void learn(const Run& run);

 private:
  void choose(const Calibration* calibration);
  /// Whether the next measurement will know it.
  bool keep() const;

  Rig& rig_;
  FocusRequest request_;
  Keeping keeping_;
  bool is_wanted_ = false;    // whether the lens says nothing, and there are spectra
  bool follows_kept_ = true;  // whether what is learned is used at once
  std::optional<LearnedBlur> kept_;
};

}  // namespace fathom
