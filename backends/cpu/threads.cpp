// SPDX-License-Identifier: Apache-2.0
#include "backends/cpu/threads.hpp"

#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cstdlib>
#include <string_view>

#include "engine/error.hpp"
#include "engine/process.hpp"

// The thread sanitizer sees nothing of what libtbb does, and would report every hand-over. Under it
// this file, half of which is oneTBB's templates, is compiled without its eyes, and says here what
// oneTBB promises; all that runs on the threads is watched (backends/CMakeLists.txt).
#ifdef FATHOM_TELL_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#else
#define __tsan_release(address) ((void)(address))  // NOLINT(bugprone-reserved-identifier)
#define __tsan_acquire(address) ((void)(address))  // NOLINT(bugprone-reserved-identifier)
#endif

namespace fathom::cpu {
namespace {

constexpr int kMostThreads = 1024;

int parse_threads(std::string_view text) {
  int count = 0;
  const char* const end = text.data() + text.size();
  const auto [next, problem] = std::from_chars(text.data(), end, count);
  if (problem != std::errc() || next != end || count < 1 || count > kMostThreads) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("FATHOM_THREADS is \"{}\"; write a number from 1 to {}, or unset it",
                            text, kMostThreads));
  }
  return count;
}

/// oneTBB has no more threads than processors, or than the program allows it, and warns on the
/// standard error stream when it is asked for more.
std::size_t usable(int count) {
  using oneapi::tbb::global_control;
  return std::min(static_cast<std::size_t>(count),
                  global_control::active_value(global_control::max_allowed_parallelism));
}

}  // namespace

int thread_count(int wished) {
  if (wished < 0 || wished > kMostThreads) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("{} threads; write a number from 1 to {}", wished, kMostThreads));
  }
  if (wished > 0) return wished;
  const char* const text = std::getenv("FATHOM_THREADS");
  if (text != nullptr && *text != '\0') return parse_threads(text);
  return std::max(1, oneapi::tbb::info::default_concurrency());
}

struct Threads::Pool {
  explicit Pool(std::size_t count) : arena(static_cast<int>(count)) {}
  oneapi::tbb::task_arena arena;
};

Threads::Threads(int count) : count_(usable(count)) {}

Threads::~Threads() = default;

/// oneTBB ends the program where a thread cannot be started, so that is tried before it does. In the
/// child of a fork its threads are gone, and it waits for them for ever.
bool Threads::has_pool() {
  static const unsigned begun_in = forks();
  if (forks() != begun_in) return false;
  std::call_once(begun_, [this] {
    const std::size_t others = count_ > 1 ? startable_threads(count_ - 1) : 0;
    if (others > 0) pool_ = std::make_unique<Pool>(others + 1);
  });
  return pool_ != nullptr;
}

void Threads::share_out(std::size_t items, std::size_t workers, Part part) {
  if (!has_pool()) return part.call(part.body, 0, items, 0);
  // As many tasks as workers, each taking the next few items until there are none: a thread that
  // comes late, or is held up, takes fewer.
  const std::size_t tasks = std::min(workers, items);
  const std::size_t chunk = std::max<std::size_t>(1, items / (tasks * 16));
  std::atomic<std::size_t> next = 0;
  char begun = 0, done = 0;  // addresses for the thread sanitizer
  const auto work = [&](std::size_t worker) {
    __tsan_acquire(&begun);
    for (;;) {
      const std::size_t begin = next.fetch_add(chunk, std::memory_order_relaxed);
      if (begin >= items) break;
      part.call(part.body, begin, std::min(items, begin + chunk), worker);
    }
    __tsan_release(&done);
  };
  __tsan_release(&begun);
  pool_->arena.execute([&] {
    oneapi::tbb::parallel_for(std::size_t{0}, tasks, work, oneapi::tbb::static_partitioner());
  });
  __tsan_acquire(&done);
}

}  // namespace fathom::cpu
