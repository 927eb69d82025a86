// SPDX-License-Identifier: Apache-2.0
#include "engine/window.hpp"
#include "fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fathom;
  Window window;
  if (!fuzz::accepted([&] { window = parse_window(fuzz::text_of(data, size)); })) return 0;
  fuzz::require(is_window_side(window.n), "its side is one that transforms take");
  fuzz::require(parse_window(to_string(window)) == window, "it is read back the same");
  if (fits(window, 4096, 4096)) {
    require_fits(window, 4096, 4096);
    fuzz::require(window.x >= 0 && window.y >= 0 && window.x <= 4096 - window.n &&
                      window.y <= 4096 - window.n,
                  "a window that fits is inside");
  }
  return 0;
}
