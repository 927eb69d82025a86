// SPDX-License-Identifier: Apache-2.0
// Whether a lens stands where it says: at its start a picture looks as it did, unless steps were lost.
#pragma once

#include <optional>
#include <span>

#include "curve.hpp"

namespace fathom {

/// How likely the pictures make it that a lens stands elsewhere than it says.
struct Slip {
  double part = 0;      ///< Of the way from `first` to `other`: how far it stands off.
  double evidence = 0;  ///< chi^2 (one degree of freedom) of that against none.
};

/// first and last: of one position, as the lens says; other: of any other, which tells how a picture
/// changes as the lens moves. Light that changes by a factor does not matter, nor what changes in
/// another way than by a lens that moves. Nothing where the pictures' cells are not known, or do not
/// change from `first` to `other` beyond noise.
std::optional<Slip> slip_of(const Evaluation& first, const Evaluation& other,
                            const Evaluation& last);

/// Whether the lens stands elsewhere in `last` than in `first`, by what any of these others tells.
bool is_slipped(const Evaluation& first, std::span<const Evaluation> others,
                const Evaluation& last);

}  // namespace fathom
