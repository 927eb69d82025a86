// SPDX-License-Identifier: Apache-2.0
// Whole files, read with a limit and written so that a failure loses nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace fathom {

/// "pipe", "socket" or "device" for what blocks or never ends when it is read, else empty. A link
/// is what it leads to.
std::string special_kind(const std::filesystem::path& path);

/// The bytes of a file. Throws Error(io) with the system's reason, Error(bad_data) if it is larger
/// than the limit (so that a wrong path cannot eat the memory), and for a pipe or a socket, unless
/// it is one that this process was given open (/dev/stdin, /dev/fd/N).
std::string read_file(const std::filesystem::path& path,
                      std::uintmax_t limit_bytes = std::uintmax_t{4} << 30);

/// Writes bytes under a temporary name beside `path`, flushes them to the disk and renames:
/// whatever fails, a file that was there before is still whole. A symbolic link is followed; a
/// device or pipe
/// (/dev/stdout) is written straight. Makes missing folders. Throws Error(io) with the system's
/// reason.
void write_file(const std::filesystem::path& path, std::string_view bytes);

/// Writes bytes into a file that nobody had before, in a folder that is made if need be: HEAD-XXXX
/// with `tail` behind it, where XXXX is random, so that processes, containers and machines that
/// share the folder never meet. Returns its path. Throws Error(io) as write_file() does, and leaves
/// no file then.
std::filesystem::path write_new_file(const std::filesystem::path& head, std::string_view tail,
                                     std::string_view bytes);

}  // namespace fathom
