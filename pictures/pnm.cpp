// SPDX-License-Identifier: Apache-2.0
// PGM and PPM (P2, P3, P5, P6): a header in ASCII, then samples in ASCII or, above 255 in
// big-endian pairs, in binary. https://netpbm.sourceforge.net/doc/pgm.html
#include <fmt/format.h>

#include <cstring>
#include <limits>
#include <vector>

#include "engine/error.hpp"
#include "pictures/decoder.hpp"
#include "pictures/grey.hpp"

namespace fathom::pictures {
namespace {

bool is_space(int c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/// Bytes one after the other, read in blocks.
class ByteReader {
 public:
  explicit ByteReader(const Source& source) : source_(source) {}

  /// The next byte, or -1 at the end.
  int next() {
    if (used_ == filled_) {
      offset_ += filled_;
      used_ = 0;
      filled_ = source_.read(offset_, block_, sizeof block_);
      if (filled_ == 0) return -1;
    }
    return block_[used_++];
  }

  std::uint64_t position() const { return offset_ + used_; }

  /// The next number; white space and # comments before it are skipped, one byte after it is taken,
  /// or a comment that stands there.
  std::uint32_t number(const char* what) {
    int c = next();
    while (is_space(c) || c == '#') {
      if (c == '#') skip_comment();
      c = next();
    }
    if (c < '0' || c > '9') throw_damaged(source_.name(), fmt::format("no number for {}", what));
    std::uint32_t value = 0;
    for (; c >= '0' && c <= '9'; c = next()) {
      value = value * 10 + static_cast<std::uint32_t>(c - '0');
      if (value > 100'000'000)
        throw_damaged(source_.name(), fmt::format("absurd number for {}", what));
    }
    if (c == '#') {
      skip_comment();
    } else if (c != -1 && !is_space(c)) {
      throw_damaged(source_.name(), fmt::format("stray character after the number for {}", what));
    }
    return value;
  }

 private:
  void skip_comment() {
    int c = next();
    while (c != '\n' && c != '\r' && c != -1) c = next();
  }

  const Source& source_;
  std::uint64_t offset_ = 0;
  std::size_t used_ = 0;
  std::size_t filled_ = 0;
  unsigned char block_[1 << 14];
};

struct Header {
  bool binary = false;
  int channels = 1;
  std::uint32_t largest = 0;  // "maxval"
  PictureShape shape;
  std::uint64_t samples = 0;
};

Header read_header(const Source& source, ByteReader& reader) {
  Header header;
  reader.next();  // 'P'
  const int kind = reader.next();
  header.binary = kind >= '5';
  header.channels = kind == '3' || kind == '6' ? 3 : 1;
  const std::uint32_t width = reader.number("the width");
  const std::uint32_t height = reader.number("the height");
  header.largest = reader.number("the largest value");
  if (header.largest < 1 || header.largest > 65535) {
    throw_damaged(source.name(),
                  fmt::format("largest value {}, must be 1 to 65535", header.largest));
  }
  header.shape = checked_shape(source.name(), width, height,
                               header.largest > 255 ? Depth::bits16 : Depth::bits8);
  header.samples = std::uint64_t{width} * height * static_cast<std::uint64_t>(header.channels);
  return header;
}

/// Throws unless every sample is within the header's own limit.
void require_within_largest(const Source& source, const Header& header, std::uint32_t value) {
  if (value <= header.largest) return;
  throw_damaged(source.name(),
                fmt::format("value {} is above the largest, {}, that its header names", value,
                            header.largest));
}

template <class Sample>
void read_binary_row(const Source& source, const Header& header, std::uint64_t offset,
                     std::vector<Sample>& row) {
  const std::size_t bytes = row.size() * sizeof(Sample);
  if (source.read(offset, row.data(), bytes) != bytes) {
    throw_damaged(source.name(), "the file ends too early");
  }
  if constexpr (sizeof(Sample) == 2) {
    for (Sample& sample : row) {
      unsigned char pair[2];
      std::memcpy(pair, &sample, 2);
      sample = static_cast<Sample>(pair[0] << 8 | pair[1]);
    }
  }
  if (header.largest == std::numeric_limits<Sample>::max()) return;  // every sample is
  for (const Sample sample : row) require_within_largest(source, header, sample);
}

template <class Sample>
Frame read_pixels(const Source& source, const Header& header, ByteReader& reader, Colour colour,
                  Colours* colours) {
  // Before memory is taken: binary samples have a fixed size, ASCII ones take two characters at
  // least, but for the last.
  const std::uint64_t least_bytes = header.samples * (header.binary ? sizeof(Sample) : 2) - 1;
  require_bytes_for(source, least_bytes, 1);
  const auto width = static_cast<std::size_t>(header.shape.width_px);
  std::vector<Sample> row(width * static_cast<std::size_t>(header.channels));
  PixelSink<Sample> sink(header.shape, header.channels, colour, colours);
  std::uint64_t offset = reader.position();
  for (int y = 0; y < header.shape.height_px; ++y) {
    if (header.binary) {
      read_binary_row(source, header, offset, row);
      offset += row.size() * sizeof(Sample);
    } else {
      for (Sample& sample : row) {
        const std::uint32_t value = reader.number("a pixel");
        require_within_largest(source, header, value);
        sample = static_cast<Sample>(value);
      }
    }
    sink.put(static_cast<std::size_t>(y), row.data());
  }
  return sink.take();
}

class PnmDecoder final : public Decoder {
 public:
  PnmDecoder(const Source& source, Colour colour) : source_(source), colour_(colour) { shape(0); }

  PictureShape shape(std::size_t) override {
    ByteReader reader(source_);
    return read_header(source_, reader).shape;
  }

  bool is_colour(std::size_t) override {
    ByteReader reader(source_);
    return read_header(source_, reader).channels > 1;
  }

  Frame read(std::size_t, Colours* colours) override {
    ByteReader reader(source_);
    const Header header = read_header(source_, reader);
    return header.shape.depth == Depth::bits16
               ? read_pixels<std::uint16_t>(source_, header, reader, colour_, colours)
               : read_pixels<std::uint8_t>(source_, header, reader, colour_, colours);
  }

 private:
  const Source& source_;
  Colour colour_;
};

}  // namespace

std::unique_ptr<Decoder> open_pnm(const Source& source, const PictureOptions& options) {
  return std::make_unique<PnmDecoder>(source, options.colour);
}

std::string encode_pgm(const Frame& frame) {
  const bool wide = frame.depth() == Depth::bits16;
  std::string file =
      fmt::format("P5\n{} {}\n{}\n", frame.width_px(), frame.height_px(), wide ? 65535 : 255);
  file.reserve(file.size() + static_cast<std::size_t>(frame.width_px()) * frame.height_px() *
                                 bytes_per_pixel(frame.depth()));
  for (int y = 0; y < frame.height_px(); ++y) {
    if (!wide) {
      file.append(reinterpret_cast<const char*>(frame.row(y)), frame.width_px());
      continue;
    }
    for (int x = 0; x < frame.width_px(); ++x) {
      const std::uint32_t value = frame.at(x, y);
      file.push_back(static_cast<char>(value >> 8));
      file.push_back(static_cast<char>(value & 0xff));
    }
  }
  return file;
}

}  // namespace fathom::pictures
