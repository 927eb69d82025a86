// SPDX-License-Identifier: Apache-2.0
// What several processes have printed with --json, put together and checked.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace fathom::cli {

/// The rows of all parts, as one process would have printed them.
struct MergedParts {
  std::vector<std::string> rows;  ///< JSON, without line ends.
  std::size_t failed = 0;         ///< Pictures that could not be scored.
};

/// Reads the outputs of `fathom score --json` or `fathom depth --json`: all shards of one run, or parts without --shard, in
/// the order given. Throws Error(bad_data) for a shard that is missing, there twice, cut off or of
/// another run, and for a window that is there twice; Error(io) as read_file() does.
MergedParts merge_parts(const std::vector<std::string>& paths);

/// Whether a file ends as a shard's output does; false where there is none.
bool is_shard(const std::string& path);

/// The rows as CSV, with a line of names above: all keys in the order in which they first come. A
/// list of K numbers, scores, becomes scores_1 to scores_K.
std::string csv_of(const MergedParts& merged);

}  // namespace fathom::cli
