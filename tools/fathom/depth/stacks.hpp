// SPDX-License-Identifier: Apache-2.0
// Maps of several stacks, each in a folder of its own, and a shard of them.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace fathom::cli {

struct StacksRequest {
  std::vector<std::string> stacks;  ///< Folders and TIFFs.
  std::string output;               ///< The folder that gets theirs.
  std::string shard;                ///< "I/N", or empty.
  std::string choices;              ///< All else that the shards of one run have in common.
};

/// Maps one stack into a folder and prints its row.
using MapStack = std::function<void(const std::string& stack, const std::string& folder)>;

/// Maps the stacks of the shard. A bad stack costs only itself, and is said. Returns the exit status.
/// Throws Error(bad_argument), before anything is mapped, for two stacks that would share a folder.
int map_stacks(const StacksRequest& request, const MapStack& map);

}  // namespace fathom::cli
