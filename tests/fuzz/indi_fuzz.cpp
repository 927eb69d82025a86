// SPDX-License-Identifier: Apache-2.0
// What an INDI server may send: its stream of XML, in pieces, and the FITS pictures in it. An input
// that begins with "SIMPLE" is a picture.
#include <algorithm>
#include <span>

#include "fuzz.hpp"
#include "hal/drivers/indi/devices.hpp"
#include "hal/drivers/indi/fits.hpp"

namespace {

using namespace fathom;

void decode(std::span<const std::byte> bytes) {
  for (const Depth depth : {Depth::bits8, Depth::bits16}) {
    fuzz::accepted([&] {
      const Frame frame = indi::decode_fits(bytes, {8, 6, depth});
      fuzz::require(frame.width_px() == 8 && frame.height_px() == 6 && frame.depth() == depth,
                    "a picture is what was expected");
    });
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kBlobLimit = 64 * 1024;
  const std::string_view text = fuzz::text_of(data, size);
  if (text.starts_with("SIMPLE")) {
    const auto* const first = reinterpret_cast<const std::byte*>(data);
    decode({first, size});
    return 0;
  }
  indi::XmlStream stream;
  indi::Devices devices;
  stream.set_blob_limit(kBlobLimit);
  // The first byte says how it is cut: a server's packets end anywhere.
  const std::size_t piece = size == 0 ? 1 : 1 + data[0];
  fuzz::accepted([&] {
    for (std::size_t at = std::min<std::size_t>(1, size); at < size; at += piece) {
      for (indi::Element& element : stream.feed(text.substr(at, piece))) {
        devices.take(std::move(element));
      }
      if (const auto picture = devices.take_picture()) {
        fuzz::require(picture->bytes.size() <= kBlobLimit, "a picture is within its limit");
        decode(picture->bytes);
      }
    }
  });
  for (const std::string& device : devices.names()) {
    fuzz::require(devices.all().lower_bound({device, ""}) != devices.all().end(),
                  "a device has properties");
  }
  return 0;
}
