// SPDX-License-Identifier: Apache-2.0
// The processors that a device may keep busy.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>

namespace fathom::cpu {

/// What was asked for; for 0 what FATHOM_THREADS says, else one per processor that this process may
/// use. Throws Error(bad_argument) for anything else than a number from 1 on.
int thread_count(int wished);

/// A fixed number of threads that share out work.
class Threads {
 public:
  /// count: from 1 on. There are fewer where this process may use fewer processors, or start fewer
  /// threads, which the first work that is shared out tells.
  explicit Threads(int count);
  ~Threads();
  Threads(const Threads&) = delete;
  Threads& operator=(const Threads&) = delete;

  /// How many compute, if this process may start them.
  std::size_t count() const { return count_; }

  /// Calls work(begin, end, worker) for parts of [0, items) on at most `workers` threads, this one
  /// among them, and returns when all is done. No two calls at a time have the same worker number,
  /// 0 .. workers-1. One worker means a plain call.
  template <class Work>
  void share(std::size_t items, std::size_t workers, const Work& work) {
    if (items <= 1 || workers <= 1) {
      if (items > 0) work(std::size_t{0}, items, std::size_t{0});
    } else {
      share_out(
          items, workers,
          {&work, [](const void* body, std::size_t begin, std::size_t end, std::size_t worker) {
             (*static_cast<const Work*>(body))(begin, end, worker);
           }});
    }
  }

 private:
  /// A callable somewhere else; std::function would allocate.
  struct Part {
    const void* body;
    void (*call)(const void* body, std::size_t begin, std::size_t end, std::size_t worker);
  };
  void share_out(std::size_t items, std::size_t workers, Part part);
  bool has_pool();

  std::size_t count_;
  std::once_flag begun_;
  struct Pool;
  std::unique_ptr<Pool> pool_;
};

}  // namespace fathom::cpu
