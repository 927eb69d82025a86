// SPDX-License-Identifier: Apache-2.0
// Whole files, read with a limit and written so that a failure loses nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace fathom {

/// The bytes of a file. Throws Error(io) with the system's reason, Error(bad_data) if it is larger
/// than the limit (so that a wrong path cannot eat the memory).
std::string read_file(const std::filesystem::path& path,
                      std::uintmax_t limit_bytes = std::uintmax_t{4} << 30);

/// Writes bytes under a temporary name beside `path`, flushes them to the disk and renames:
/// whatever fails, a file that was there before is still whole. A symbolic link is followed; a
/// device or pipe
/// (/dev/stdout) is written straight. Makes missing folders. Throws Error(io) with the system's
/// reason.
void write_file(const std::filesystem::path& path, std::string_view bytes);

}  // namespace fathom
