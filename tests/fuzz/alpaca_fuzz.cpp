// SPDX-License-Identifier: Apache-2.0
// What an Alpaca server may send: pictures as bytes or JSON, answers to a discovery.
#include "fuzz.hpp"
#include "hal/drivers/alpaca/discovery.hpp"
#include "hal/drivers/alpaca/image.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fathom;
  using namespace fathom::alpaca;
  constexpr std::size_t kHead = 3;
  if (size < kHead) return 0;
  const ImageShape shape{1 + data[1] % 16, 1 + data[2] % 16,
                         data[0] % 2 == 0 ? Depth::bits8 : Depth::bits16};
  const auto check = [&](const Frame& frame) {
    fuzz::require(frame.width_px() == shape.width_px && frame.height_px() == shape.height_px &&
                      frame.depth() == shape.depth,
                  "a frame has the shape that was agreed");
  };
  const std::string_view text = fuzz::text_of(data + kHead, size - kHead);
  fuzz::accepted([&] { check(frame_of_bytes({data + kHead, size - kHead}, shape)); });
  fuzz::accepted([&] { check(frame_of_json(text, shape)); });
  const int port = port_in(text);
  fuzz::require(port >= 0 && port < 65536, "a port is a port");
  return 0;
}
