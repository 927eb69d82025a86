// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/aravis/pixels.hpp"

#include <algorithm>
#include <vector>

#include "hal/drivers/aravis/mosaic.hpp"

namespace fathom::aravis {
namespace {

constexpr PixelFormat kFormats[] = {
    {0x01100007, "Mono16", 16, Packing::words, Mosaic::none},
    {0x01100025, "Mono14", 14, Packing::words, Mosaic::none},
    {0x01100005, "Mono12", 12, Packing::words, Mosaic::none},
    {0x010C0047, "Mono12p", 12, Packing::stream, Mosaic::none},
    {0x010C0006, "Mono12Packed", 12, Packing::pairs, Mosaic::none},
    {0x01100003, "Mono10", 10, Packing::words, Mosaic::none},
    {0x010A0046, "Mono10p", 10, Packing::stream, Mosaic::none},
    {0x010C0004, "Mono10Packed", 10, Packing::pairs, Mosaic::none},
    {0x01080001, "Mono8", 8, Packing::bytes, Mosaic::none},
    {0x0110002E, "BayerGR16", 16, Packing::words, Mosaic::gr},
    {0x0110002F, "BayerRG16", 16, Packing::words, Mosaic::rg},
    {0x01100030, "BayerGB16", 16, Packing::words, Mosaic::gb},
    {0x01100031, "BayerBG16", 16, Packing::words, Mosaic::bg},
    {0x01100010, "BayerGR12", 12, Packing::words, Mosaic::gr},
    {0x01100011, "BayerRG12", 12, Packing::words, Mosaic::rg},
    {0x01100012, "BayerGB12", 12, Packing::words, Mosaic::gb},
    {0x01100013, "BayerBG12", 12, Packing::words, Mosaic::bg},
    {0x010C0057, "BayerGR12p", 12, Packing::stream, Mosaic::gr},
    {0x010C0059, "BayerRG12p", 12, Packing::stream, Mosaic::rg},
    {0x010C0055, "BayerGB12p", 12, Packing::stream, Mosaic::gb},
    {0x010C0053, "BayerBG12p", 12, Packing::stream, Mosaic::bg},
    {0x010C002A, "BayerGR12Packed", 12, Packing::pairs, Mosaic::gr},
    {0x010C002B, "BayerRG12Packed", 12, Packing::pairs, Mosaic::rg},
    {0x010C002C, "BayerGB12Packed", 12, Packing::pairs, Mosaic::gb},
    {0x010C002D, "BayerBG12Packed", 12, Packing::pairs, Mosaic::bg},
    {0x0110000C, "BayerGR10", 10, Packing::words, Mosaic::gr},
    {0x0110000D, "BayerRG10", 10, Packing::words, Mosaic::rg},
    {0x0110000E, "BayerGB10", 10, Packing::words, Mosaic::gb},
    {0x0110000F, "BayerBG10", 10, Packing::words, Mosaic::bg},
    {0x010A0056, "BayerGR10p", 10, Packing::stream, Mosaic::gr},
    {0x010A0058, "BayerRG10p", 10, Packing::stream, Mosaic::rg},
    {0x010A0054, "BayerGB10p", 10, Packing::stream, Mosaic::gb},
    {0x010A0052, "BayerBG10p", 10, Packing::stream, Mosaic::bg},
    {0x010C0026, "BayerGR10Packed", 10, Packing::pairs, Mosaic::gr},
    {0x010C0027, "BayerRG10Packed", 10, Packing::pairs, Mosaic::rg},
    {0x010C0028, "BayerGB10Packed", 10, Packing::pairs, Mosaic::gb},
    {0x010C0029, "BayerBG10Packed", 10, Packing::pairs, Mosaic::bg},
    {0x01080008, "BayerGR8", 8, Packing::bytes, Mosaic::gr},
    {0x01080009, "BayerRG8", 8, Packing::bytes, Mosaic::rg},
    {0x0108000A, "BayerGB8", 8, Packing::bytes, Mosaic::gb},
    {0x0108000B, "BayerBG8", 8, Packing::bytes, Mosaic::bg},
};

/// Bits that a pixel takes in memory.
std::size_t stored_bits(const PixelFormat& format) {
  switch (format.packing) {
    case Packing::bytes:
      return 8;
    case Packing::words:
      return 16;
    case Packing::pairs:
      return 12;
    case Packing::stream:
      return static_cast<std::size_t>(format.bits);
  }
  return 0;
}

std::size_t bytes_of(const PixelFormat& format, std::size_t pixels) {
  return (pixels * stored_bits(format) + 7) / 8;
}

/// The i-th pixel of a row of packed ones.
std::uint16_t from_pair(const std::uint8_t* bytes, std::size_t i, int bits) {
  const std::uint8_t* const pair = bytes + i / 2 * 3;
  const int low_bits = bits - 8, low_mask = (1 << low_bits) - 1;
  const int high = i % 2 == 0 ? pair[0] : pair[2];
  const int low = (i % 2 == 0 ? pair[1] : pair[1] >> 4) & low_mask;
  return static_cast<std::uint16_t>(high << low_bits | low);
}

std::uint16_t from_stream(const std::uint8_t* bytes, std::size_t i, int bits) {
  const std::size_t first = i * static_cast<std::size_t>(bits);
  // 10 or 12 bits that begin at an even bit lie within two bytes.
  const int both = bytes[first / 8] | bytes[first / 8 + 1] << 8;
  return static_cast<std::uint16_t>(both >> first % 8 & ((1 << bits) - 1));
}

template <class Sample>
Sample pixel(const PixelFormat& format, const std::uint8_t* bytes, std::size_t i) {
  switch (format.packing) {
    case Packing::bytes:
      return static_cast<Sample>(bytes[i]);
    case Packing::words:
      return static_cast<Sample>(bytes[2 * i] | bytes[2 * i + 1] << 8);
    case Packing::pairs:
      return static_cast<Sample>(from_pair(bytes, i, format.bits));
    case Packing::stream:
      return static_cast<Sample>(from_stream(bytes, i, format.bits));
  }
  return 0;
}

/// Rows without padding follow each other bit by bit; padded ones begin with a byte.
template <class Sample>
std::vector<Sample> unpack(const PixelFormat& format, const Layout& layout,
                           const std::uint8_t* bytes) {
  const auto width = static_cast<std::size_t>(layout.width_px);
  const auto height = static_cast<std::size_t>(layout.height_px);
  const bool is_padded = layout.padding_bytes > 0;
  const std::size_t rows = is_padded ? height : 1, in_row = is_padded ? width : width * height;
  const std::size_t stride = bytes_of(format, in_row) + layout.padding_bytes;
  std::vector<Sample> samples;
  samples.reserve(width * height);
  for (std::size_t y = 0; y < rows; ++y) {
    for (std::size_t i = 0; i < in_row; ++i)
      samples.push_back(pixel<Sample>(format, bytes + y * stride, i));
  }
  return samples;
}

std::size_t least_bytes(const PixelFormat& format, const Layout& layout) {
  const auto width = static_cast<std::size_t>(layout.width_px);
  const auto height = static_cast<std::size_t>(layout.height_px);
  if (layout.padding_bytes == 0) return bytes_of(format, width * height);
  return (bytes_of(format, width) + layout.padding_bytes) * (height - 1) + bytes_of(format, width);
}

template <class Sample>
Frame grey_of(const PixelFormat& format, const Layout& layout, MosaicUse use,
              const std::uint8_t* bytes) {
  std::vector<Sample> samples = unpack<Sample>(format, layout, bytes);
  const int width = side_of(layout.width_px, format, use);
  const int height = side_of(layout.height_px, format, use);
  if (format.is_mosaic()) {
    samples = use == MosaicUse::luma
                  ? interpolated(samples, layout.width_px, layout.height_px, format.mosaic)
                  : one_colour(samples, layout.width_px, {width, height}, format.mosaic, use);
  }
  return Frame(width, height, std::move(samples));
}

}  // namespace

std::span<const PixelFormat> pixel_formats() { return kFormats; }

const PixelFormat* find_pixel_format(std::uint32_t code) {
  const auto* const found =
      std::find_if(std::begin(kFormats), std::end(kFormats),
                   [&](const PixelFormat& format) { return format.code == code; });
  return found == std::end(kFormats) ? nullptr : found;
}

int side_of(int sensor_px, const PixelFormat& format, MosaicUse use) {
  return format.is_mosaic() && use != MosaicUse::luma ? sensor_px / 2 : sensor_px;
}

std::optional<Frame> to_grey(const PixelFormat& format, const Layout& layout, MosaicUse use,
                             std::span<const std::uint8_t> bytes) {
  if (layout.width_px <= 0 || layout.height_px <= 0) return std::nullopt;
  if (format.is_mosaic() && (layout.width_px < 2 || layout.height_px < 2)) return std::nullopt;
  if (bytes.size() < least_bytes(format, layout)) return std::nullopt;
  return format.depth() == Depth::bits8 ? grey_of<std::uint8_t>(format, layout, use, bytes.data())
                                        : grey_of<std::uint16_t>(format, layout, use, bytes.data());
}

}  // namespace fathom::aravis
