// SPDX-License-Identifier: Apache-2.0
// The order that names stand for: frame_2 before frame_10, lens_0.25 before lens_0.5, z_-1 before
// z_0.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/finding.hpp"

namespace fathom::replay {

/// Whether a stands before b in the order that people expect: pcb_2 before pcb_10.
bool natural_less(std::string_view a, std::string_view b);

struct OrderedNames {
  std::vector<std::size_t> order;  ///< Indices into the names given, in their order.
  /// Whether the names, but for a few, differ in numbers alone, and stand in the order of those.
  bool by_numbers = false;
  std::optional<MissingNumbers> gap;
  std::optional<NamesTwice> twice;
};

/// The order of file names. Where nearly all share one text and differ in numbers alone, numbers
/// count as numbers: with decimals, signs and exponents, as programs print them. A point is a decimal
/// point unless a fraction ends in 0 (chapter 1.10 comes after 1.9). A minus is a sign behind one of
/// _ = or a blank, or where only some of the names have it. Else it is natural_less().
OrderedNames order_of(const std::vector<std::string>& names);

}  // namespace fathom::replay
