// SPDX-License-Identifier: Apache-2.0
#include "hal/approach.hpp"

#include <algorithm>

namespace fathom {

double accuracy_of(const LensInfo& info) {
  constexpr double kPartOfTravel = 5e-4;
  return std::max(1.5 * info.resolution, kPartOfTravel * (info.highest - info.lowest));
}

std::vector<int> approach_moves(int from, int to, int takeup_steps, int lowest) {
  if (to == from) return {};
  if (to > from) return {to - from};
  const int turn = std::max(to - takeup_steps, lowest);
  if (turn == to) return {to - from};
  return {turn - from, to - turn};
}

std::vector<int> approach_moves_in_doubt(int from, int to, int takeup_steps, int lowest) {
  const int turn = std::max(to - takeup_steps, lowest);
  if (from <= turn) return approach_moves(from, to, takeup_steps, lowest);
  std::vector<int> moves{turn - from};
  if (to > turn) moves.push_back(to - turn);
  return moves;
}

std::vector<int> approach_moves(bool is_approached, int from, int to, int takeup_steps,
                                int lowest) {
  return is_approached ? approach_moves(from, to, takeup_steps, lowest)
                       : approach_moves_in_doubt(from, to, takeup_steps, lowest);
}

}  // namespace fathom
