// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstring>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "backends/backends.hpp"
#include "capi/fathom.h"
#include "engine/error.hpp"
#include "engine/one_thread.hpp"
#include "engine/scorer.hpp"

struct fathom_plan {
  fathom::Scorer scorer;
  std::string metric;
  std::vector<fathom::Window> windows = {};  // room for a call's windows
  fathom::OneThread door = {};               // they are one call's at a time
};

namespace {

using fathom::Error;
using fathom::ErrorCode;

/// How the thread's last call ended. A fixed array, because telling of missing memory must need
/// none.
struct Outcome {
  fathom_status status = FATHOM_OK;
  std::array<char, 1024> text{};

  fathom_status set(fathom_status ended, std::string_view why) noexcept {
    status = ended;
    const std::size_t length = std::min(why.size(), text.size() - 1);
    std::memcpy(text.data(), why.data(), length);
    text[length] = '\0';
    return status;
  }
};

thread_local Outcome last_outcome;

fathom_status status_of(ErrorCode code) noexcept {
  switch (code) {
    case ErrorCode::bad_argument:
      return FATHOM_BAD_ARGUMENT;
    case ErrorCode::out_of_bounds:
      return FATHOM_OUT_OF_BOUNDS;
    case ErrorCode::bad_data:
      return FATHOM_BAD_DATA;
    case ErrorCode::io:
      return FATHOM_IO;
    case ErrorCode::unavailable:
      return FATHOM_UNAVAILABLE;
    case ErrorCode::unsupported:
      return FATHOM_UNSUPPORTED;
    case ErrorCode::device_lost:
      return FATHOM_DEVICE_LOST;
    case ErrorCode::out_of_memory:
      return FATHOM_OUT_OF_MEMORY;
    case ErrorCode::timeout:
      return FATHOM_TIMEOUT;
    case ErrorCode::cancelled:
      return FATHOM_CANCELLED;
  }
  return FATHOM_INTERNAL;
}

/// Runs the call and turns whatever it throws into the thread's outcome.
template <class Call>
fathom_status guarded(Call&& call) noexcept {
  try {
    call();
    return last_outcome.set(FATHOM_OK, "");
  } catch (const Error& error) {
    return last_outcome.set(status_of(error.code()), error.what());
  } catch (const std::bad_alloc&) {
    return last_outcome.set(FATHOM_OUT_OF_MEMORY, "out of memory");
  } catch (const std::exception& error) {
    return last_outcome.set(FATHOM_INTERNAL, error.what());
  } catch (...) {
    return last_outcome.set(FATHOM_INTERNAL, "an exception that says nothing");
  }
}

void require(bool holds, const char* otherwise) {
  if (!holds) throw Error(ErrorCode::bad_argument, otherwise);
}

fathom::Depth depth_of(int bits) {
  require(bits >= 8 && bits <= 16,
          "bits must be 8 (one byte a pixel) or 9 to 16 (two bytes a pixel)");
  return bits == 8 ? fathom::Depth::bits8 : fathom::Depth::bits16;
}

fathom::Frame view(const void* pixels, int width, int height, int bits, std::size_t stride_bytes) {
  const fathom::Depth depth = depth_of(bits);
  if (stride_bytes == 0 && width > 0) {
    stride_bytes = static_cast<std::size_t>(width) * fathom::bytes_per_pixel(depth);
  }
  return fathom::Frame::view(pixels, width, height, depth, stride_bytes);
}

}  // namespace

extern "C" {

fathom_plan* fathom_open(const char* metric, const char* backend, std::size_t capacity) {
  std::unique_ptr<fathom_plan> opened;
  guarded([&] {
    require(metric != nullptr, "the metric is NULL; pass a text such as \"fft:64:hann\"");
    const auto spec = fathom::MetricSpec::parse(metric);
    auto selection = fathom::select_device(fathom::all_backends(),
                                           backend != nullptr ? backend : "", spec, capacity);
    opened = std::unique_ptr<fathom_plan>(
        new fathom_plan{fathom::Scorer(std::move(selection), spec, capacity), spec.text()});
  });
  return opened.release();
}

fathom_status fathom_score(fathom_plan* plan, const void* pixels, int width, int height, int bits,
                           std::size_t stride_bytes, const fathom_window* windows,
                           std::size_t count, double* scores) {
  return guarded([&] {
    require(plan != nullptr, "the plan is NULL; did fathom_open fail?");
    require(count == 0 || (windows != nullptr && scores != nullptr),
            "windows and scores must not be NULL");
    const fathom::OneThread::Inside inside(plan->door);
    const fathom::Frame frame = view(pixels, width, height, bits, stride_bytes);
    require(count <= plan->scorer.batch(), "more windows than the capacity given to fathom_open");
    plan->windows.clear();
    for (const fathom_window& window : std::span(windows, count)) {
      plan->windows.push_back({window.x, window.y, window.n});
    }
    plan->scorer.score(frame, plan->windows, {scores, count * plan->scorer.outputs()});
  });
}

fathom_status fathom_score_window(fathom_plan* plan, const void* pixels, int width, int height,
                                  int bits, std::size_t stride_bytes, int x, int y, double* score) {
  const fathom_window window = {x, y, plan != nullptr ? plan->scorer.spec().n : 0};
  return fathom_score(plan, pixels, width, height, bits, stride_bytes, &window, 1, score);
}

const char* fathom_metric(const fathom_plan* plan) {
  return plan != nullptr ? plan->metric.c_str() : "";
}

std::size_t fathom_outputs(const fathom_plan* plan) {
  return plan != nullptr ? plan->scorer.outputs() : 0;
}

const char* fathom_device(const fathom_plan* plan) {
  return plan != nullptr ? plan->scorer.selection().reason.c_str() : "";
}

void fathom_close(fathom_plan* plan) { delete plan; }

fathom_status fathom_error_status(void) { return last_outcome.status; }

const char* fathom_error_text(void) { return last_outcome.text.data(); }

const char* fathom_version(void) { return FATHOM_VERSION; }

}  // extern "C"
