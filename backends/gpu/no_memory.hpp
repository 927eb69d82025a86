// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include "engine/error.hpp"

namespace fathom::gpu {

/// What to throw where a device has not got so many bytes: how much, what for, what to try.
Error no_memory(std::string_view device, std::uint64_t bytes, std::string_view what,
                std::string_view why);

}  // namespace fathom::gpu
