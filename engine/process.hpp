// SPDX-License-Identifier: Apache-2.0
// What a library must know of the process that it is in.
#pragma once

#include <cstddef>

namespace fathom {

/// How many forks lie between this process and the one in which this was asked first. Threads and
/// drivers of a process do not come along into its child.
unsigned forks();

/// How many threads, up to so many, this process can start beside those that it has: all of them
/// are started, and end at once. A limit of the user or of a container may leave fewer, and
/// libraries that start threads abort where they get none.
std::size_t startable_threads(std::size_t wanted);

/// Whether a driver that has a thread for each processor gets them.
bool can_start_drivers();

}  // namespace fathom
