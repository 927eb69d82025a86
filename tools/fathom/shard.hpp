// SPDX-License-Identifier: Apache-2.0
// --shard I/N: one machine's part of what is to be done, and the line by which parts are known.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace fathom::cli {

/// The number-th of so many parts, from 1.
struct Shard {
  std::size_t number = 1;
  std::size_t count = 1;

  /// Throws Error(bad_argument) for what is no "I/N".
  static Shard parse(std::string_view text);
  /// First and one past the last of its things. All shards together have each thing once, in order.
  std::pair<std::size_t, std::size_t> part_of(std::size_t things) const;
};

/// The last line of a shard's output. Without it the output is cut off.
struct ShardEnd {
  Shard shard;
  std::uint64_t command = 0;  ///< Hash of all that the shards of one run have in common.
  std::size_t rows = 0;
  std::size_t failed = 0;  ///< Pictures that could not be scored.

  /// Without a line end.
  std::string text() const;
};

}  // namespace fathom::cli
