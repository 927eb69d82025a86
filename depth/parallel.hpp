// SPDX-License-Identifier: Apache-2.0
// Work on parts of a range, shared out between a few threads.
//
// backends/cpu/threads.hpp does the same on oneTBB's threads, which live as long as a device: there a
// call takes microseconds. Here it takes a tenth of a second and more, a new thread costs nothing, and
// exceptions go through. Neither folder may include the other, and the engine, which both may, is to
// need no library for threads.
#pragma once

#include <cstddef>
#include <functional>

namespace fathom::depth {

/// Calls work(begin, end) for parts of [0, items) of at most `part` each, on at most `threads`
/// threads, this one among them, which looks for interruptions. Where a part throws, the first
/// exception is thrown on, at the end.
void share_out(std::size_t items, std::size_t part, int threads,
               const std::function<void(std::size_t begin, std::size_t end)>& work);

}  // namespace fathom::depth
