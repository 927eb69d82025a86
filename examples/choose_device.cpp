// SPDX-License-Identifier: Apache-2.0
// Chooses what computes, says why, and tells one failure from another.
//
//   choose_device [auto | cpu | vulkan | opencl:0 | ...]
#include <fathom/backends/backends.hpp>
#include <fathom/engine/error.hpp>
#include <fathom/engine/selection.hpp>

#include <cstdio>
#include <string>

int main(int argc, char** argv) {
  const auto spec = fathom::MetricSpec::parse("fft:64:hann");
  const std::size_t windows = 10000;  // A call: so many that a GPU is worth looking for.

  fathom::DeviceOptions options;
  options.threads = 2;  // Of the processors; a GPU takes none.
  options.on_work = [](fathom::Work work, const std::string& subject) {
    if (work == fathom::Work::timing) std::fprintf(stderr, "timing %s ...\n", subject.c_str());
  };

  try {
    const auto selection = fathom::select_device(
        fathom::all_backends(), argc > 1 ? argv[1] : "auto", spec, windows, options);
    std::printf("%s\n", selection.reason.c_str());
  } catch (const fathom::Error& error) {
    std::fprintf(stderr, "choose_device: %s\n", error.what());
    return error.code() == fathom::ErrorCode::unavailable ? 3 : 1;
  }
}
