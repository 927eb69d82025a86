// SPDX-License-Identifier: Apache-2.0
// Backlash, handled once for every motor.
#pragma once

#include <vector>

#include "../engine/travel.hpp"

namespace fathom {

/// How far from where it was sent a lens may come to rest and still have arrived: one step, or what
/// a long travel hides (a two-thousandth of it).
double accuracy_of(const LensInfo& info);

/// The relative moves, in steps and in order, that bring a motor from one absolute position to
/// another so that the last one always goes upward: a downward move goes `takeup_steps` too far and
/// comes back, which takes up the play of the gears on the same side each time. Never goes below
/// `lowest`; at `lowest` itself the end stop takes the place of the approach. Empty where already
/// there.
std::vector<int> approach_moves(int from, int to, int takeup_steps, int lowest);

/// The same from where nobody knows on which side the play lies: upward moves shorter than the
/// take-up start with a downward one too, and so does one to where the motor stands already.
std::vector<int> approach_moves_in_doubt(int from, int to, int takeup_steps, int lowest);

/// One of the two. is_approached: it came to `from` from below, far enough to take up the play.
std::vector<int> approach_moves(bool is_approached, int from, int to, int takeup_steps, int lowest);

}  // namespace fathom
