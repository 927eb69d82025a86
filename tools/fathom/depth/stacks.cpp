// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/depth/stacks.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <map>

#include "engine/cache.hpp"
#include "engine/error.hpp"
#include "engine/printable.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/shard.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {
namespace {

/// Named like the stack, without its ending.
std::string folder_of(const std::string& output, const std::string& stack) {
  std::filesystem::path path = std::filesystem::path(stack).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  std::string name = path.filename().string();
  for (const std::string_view ending : {".tif", ".tiff", ".ome"}) {
    if (name.size() > ending.size() && name.ends_with(ending))
      name.resize(name.size() - ending.size());
  }
  return (std::filesystem::path(output) / name).string();
}

void require_own_folders(const StacksRequest& request) {
  std::map<std::string, std::string> stack_of;
  for (const std::string& stack : request.stacks) {
    const auto [before, is_new] = stack_of.emplace(folder_of(request.output, stack), stack);
    if (is_new) continue;
    throw Error(ErrorCode::bad_argument,
                fmt::format("{} and {} would both be mapped in {}; map one of them in a call of "
                            "its own, with another -o",
                            printable(before->second), printable(stack), printable(before->first)));
  }
}

std::uint64_t hash_of_command(const StacksRequest& request) {
  std::string text = request.choices;
  for (const std::string& stack : request.stacks) text += '\0' + stack;
  return hash_of(text);
}

}  // namespace

int map_stacks(const StacksRequest& request, const MapStack& map) {
  const Shard shard = request.shard.empty() ? Shard() : Shard::parse(request.shard);
  require_own_folders(request);
  std::error_code ignored;  // what cannot be made is said by the first map
  std::filesystem::create_directories(request.output, ignored);
  std::size_t rows = 0, failed = 0;
  const auto [first, last] = shard.part_of(request.stacks.size());
  for (std::size_t i = first; i < last; ++i) {
    const std::string& stack = request.stacks[i];
    try {
      map(stack, folder_of(request.output, stack));
      ++rows;
    } catch (const Error& error) {
      if (error.code() == ErrorCode::cancelled) throw;
      note(fmt::format("{}: {}", printable(stack), error.what()));
      ++failed;
    }
  }
  if (!request.shard.empty()) {
    const ShardEnd end = {
        .shard = shard, .command = hash_of_command(request), .rows = rows, .failed = failed};
    print_line(end.text());
  }
  return failed == 0 ? kDone : kError;
}

}  // namespace fathom::cli
