// SPDX-License-Identifier: Apache-2.0
// Any bytes are a picture of the size that its header names, or an Error.
#include <algorithm>

#include "fuzz.hpp"
#include "pictures/picture.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fathom;
  fuzz::accepted([&] {
    PictureFile file(fuzz::text_of(data, size), "fuzzed");
    const std::size_t pages = std::min<std::size_t>(file.page_count(), 3);
    for (std::size_t page = 0; page < pages; ++page) {
      fuzz::accepted([&] {
        const PictureShape shape = file.shape(page);
        // A file of 8 KiB may honestly hold some hundred megapixels of one grey; that is slow, not
        // wrong.
        if (std::size_t{1} * shape.width_px * shape.height_px > (1u << 20)) return;
        const Frame frame = file.read(page);
        fuzz::require(shape == PictureShape{frame.width_px(), frame.height_px(), frame.depth()},
                      "the pixels are as many as the header says");
        std::uint32_t largest = 0;  // reads every pixel, for the sanitizers
        for (int y = 0; y < frame.height_px(); ++y) {
          for (int x = 0; x < frame.width_px(); ++x) largest = std::max(largest, frame.at(x, y));
        }
        fuzz::require(largest <= 65535, "grey values are 16 bit");
      });
    }
  });
  return 0;
}
