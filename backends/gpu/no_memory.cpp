// SPDX-License-Identifier: Apache-2.0
#include "backends/gpu/no_memory.hpp"

#include <fmt/format.h>

namespace fathom::gpu {
namespace {

/// 12.3 MiB; small ones in bytes.
std::string size_text(std::uint64_t bytes) {
  return bytes < 1U << 20 ? fmt::format("{} bytes", bytes)
                          : fmt::format("{:.1f} MiB", static_cast<double>(bytes) / (1U << 20));
}

}  // namespace

Error no_memory(std::string_view device, std::uint64_t bytes, std::string_view what,
                std::string_view why) {
  return Error(ErrorCode::out_of_memory,
               fmt::format("{} did not get {} for {}: {}; try a smaller capacity, or pictures of "
                           "fewer pixels",
                           device, size_text(bytes), what, why));
}

}  // namespace fathom::gpu
