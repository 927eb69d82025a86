// SPDX-License-Identifier: Apache-2.0
// The table of searches: what each is called, what it wants to know beforehand, and how it runs.
#pragma once

#include <span>

#include "focus.hpp"

namespace fathom {

/// One way to search.
struct Search {
  SearchMethod method;
  const char* name;  ///< As a user writes it.
  const char* help;  ///< A few words, in brackets behind the name; may be empty.
  /// Whether it begins at limits.start, where the lens stands unless asked otherwise; else at
  /// limits.from.
  bool begins_at_start;
  /// Fills what this search needs of the limits: coarse, start, first_step. All else is resolved.
  void (*prepare)(FocusLimits& limits, const FocusRequest& request, const LensInfo& lens);
  /// Evaluates what it wants to see. Throws what the objective throws.
  void (*run)(SearchTrace& trace, const FocusLimits& limits, const Scatter& scatter);
};

/// All of them, in the order of SearchMethod.
std::span<const Search> searches();

const Search& search_of(SearchMethod method);

}  // namespace fathom
