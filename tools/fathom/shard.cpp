// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/shard.hpp"

#include <fmt/format.h>

#include <charconv>

#include "engine/error.hpp"
#include "engine/printable.hpp"
#include "tools/fathom/console.hpp"

namespace fathom::cli {
namespace {

/// Beyond this many, the products of part_of() might overflow.
constexpr std::size_t kMostShards = 1'000'000;

bool read_number(std::string_view text, std::size_t& number) {
  const char* const end = text.data() + text.size();
  const auto [next, problem] = std::from_chars(text.data(), end, number);
  return problem == std::errc() && next == end && number >= 1 && number <= kMostShards;
}

}  // namespace

Shard Shard::parse(std::string_view text) {
  const std::size_t slash = text.find('/');
  Shard shard;
  if (slash == std::string_view::npos || !read_number(text.substr(0, slash), shard.number) ||
      !read_number(text.substr(slash + 1), shard.count) || shard.number > shard.count) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("--shard {}: write I/N, the I-th of N parts, such as 1/8 to 8/8",
                            printable(text)));
  }
  return shard;
}

std::pair<std::size_t, std::size_t> Shard::part_of(std::size_t things) const {
  return {things * (number - 1) / count, things * number / count};
}

std::string ShardEnd::text() const {
  return JsonLine()
      .add("shard", shard.number)
      .add("shards", shard.count)
      .add("command", fmt::format("{:016x}", command))
      .add("rows", rows)
      .add("failed", failed)
      .text();
}

}  // namespace fathom::cli
