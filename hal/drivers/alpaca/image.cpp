// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/alpaca/image.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/error.hpp"
#include "hal/drivers/alpaca/connection.hpp"
#include "pictures/grey.hpp"

namespace fathom::alpaca {
namespace {

using nlohmann::json;

constexpr std::size_t kHeaderBytes = 44;
constexpr const char* kWhat = "imagearray";

[[noreturn]] void fail(const std::string& why) {
  throw Error(ErrorCode::bad_data, "the Alpaca picture " + why);
}

std::uint64_t bits_at(const std::uint8_t* bytes, int size) {
  std::uint64_t bits = 0;
  for (int i = size - 1; i >= 0; --i) bits = bits << 8 | bytes[i];
  return bits;
}

template <class Float, class Bits>
double floating(std::uint64_t bits) {
  const auto narrow = static_cast<Bits>(bits);
  Float value;
  std::memcpy(&value, &narrow, sizeof value);
  return value;
}

/// Numbers of the types that the protocol counts: their size, and what their bits say.
struct Element {
  int type;
  int bytes;
  double (*value)(std::uint64_t bits);
};
constexpr Element kElements[] = {
    {1, 2, [](std::uint64_t bits) { return static_cast<double>(static_cast<std::int16_t>(bits)); }},
    {2, 4, [](std::uint64_t bits) { return static_cast<double>(static_cast<std::int32_t>(bits)); }},
    {3, 8, [](std::uint64_t bits) { return floating<double, std::uint64_t>(bits); }},
    {4, 4, [](std::uint64_t bits) { return floating<float, std::uint32_t>(bits); }},
    {5, 8, [](std::uint64_t bits) { return static_cast<double>(bits); }},
    {6, 1, [](std::uint64_t bits) { return static_cast<double>(bits); }},
    {7, 8, [](std::uint64_t bits) { return static_cast<double>(static_cast<std::int64_t>(bits)); }},
    {8, 2, [](std::uint64_t bits) { return static_cast<double>(bits); }},
    {9, 4, [](std::uint64_t bits) { return static_cast<double>(bits); }},
};

const Element& element_of(std::int32_t type) {
  for (const Element& element : kElements) {
    if (element.type == type) return element;
  }
  fail(fmt::format("has elements of the unknown type {}", type));
}

/// Samples column by column, `planes` of each pixel, to a frame row by row. at(i): the i-th sample.
template <class Sample, class At>
Frame frame_of(const ImageShape& shape, int planes, At at) {
  constexpr double kMost = std::numeric_limits<Sample>::max();
  const auto sample = [&](std::size_t i) {
    const double value = at(i);
    if (!(value >= 0 && value <= kMost))
      fail(fmt::format("has a value of {}, beyond {} to {}", value, 0, kMost));
    return static_cast<Sample>(std::lround(value));
  };
  std::vector<Sample> grey;
  grey.reserve(static_cast<std::size_t>(shape.width_px) * shape.height_px);
  for (int y = 0; y < shape.height_px; ++y) {
    for (int x = 0; x < shape.width_px; ++x) {
      const std::size_t i =
          (static_cast<std::size_t>(x) * shape.height_px + y) * static_cast<std::size_t>(planes);
      grey.push_back(planes == 1 ? sample(i)
                                 : pictures::luma(sample(i), sample(i + 1), sample(i + 2)));
    }
  }
  return Frame(shape.width_px, shape.height_px, std::move(grey));
}

template <class At>
Frame frame_of(const ImageShape& shape, int planes, At at) {
  return shape.depth == Depth::bits8 ? frame_of<std::uint8_t>(shape, planes, at)
                                     : frame_of<std::uint16_t>(shape, planes, at);
}

/// 1 plane or 3.
int planes_of(const ImageShape& shape, std::int64_t rank, std::int64_t width, std::int64_t height,
              std::int64_t planes) {
  if (width != shape.width_px || height != shape.height_px)
    fail(fmt::format("is of {} x {} px, not {} x {}", width, height, shape.width_px,
                     shape.height_px));
  if (rank == 2) return 1;
  if (rank == 3 && planes == 3) return 3;
  fail(fmt::format("has rank {} and {} planes", rank, planes));
}

/// Of an array that is what it should be; 0 else.
std::int64_t size_of(const json& array) {
  return array.is_array() ? static_cast<std::int64_t>(array.size()) : 0;
}

}  // namespace

Frame frame_of_bytes(std::span<const std::uint8_t> bytes, const ImageShape& shape) {
  if (bytes.size() < kHeaderBytes) fail("ends within its header");
  std::int32_t head[kHeaderBytes / 4];
  for (std::size_t i = 0; i < std::size(head); ++i)
    head[i] = static_cast<std::int32_t>(bits_at(bytes.data() + 4 * i, 4));
  const std::int32_t version = head[0], error = head[1], start = head[4], type = head[6],
                     rank = head[7];
  if (version != 1) fail(fmt::format("is of version {} of ImageBytes; 1 is read", version));
  if (start < static_cast<std::int32_t>(kHeaderBytes) ||
      static_cast<std::size_t>(start) > bytes.size()) {
    fail(fmt::format("begins at byte {} of {}", start, bytes.size()));
  }
  const auto data = bytes.subspan(static_cast<std::size_t>(start));
  const std::string_view said(reinterpret_cast<const char*>(data.data()), data.size());
  require_no_error(error, error == 0 ? "" : said, kWhat);
  const Element& element = element_of(type);
  const int planes = planes_of(shape, rank, head[8], head[9], head[10]);
  const std::size_t count =
      static_cast<std::size_t>(shape.width_px) * shape.height_px * static_cast<std::size_t>(planes);
  if (data.size() < count * static_cast<std::size_t>(element.bytes))
    fail(fmt::format("has {} bytes where {} should be", data.size(), count * element.bytes));
  return frame_of(shape, planes, [&](std::size_t i) {
    return element.value(
        bits_at(data.data() + i * static_cast<std::size_t>(element.bytes), element.bytes));
  });
}

Frame frame_of_json(std::string_view text, const ImageShape& shape) {
  const json answer = json::parse(text, nullptr, false);
  if (!answer.is_object()) fail("is no JSON object");
  const auto number = [&](const char* key) {
    const auto found = answer.find(key);
    return found != answer.end() && found->is_number_integer() ? found->get<std::int64_t>() : 0;
  };
  const auto message = answer.find("ErrorMessage");
  require_no_error(
      number("ErrorNumber"),
      message != answer.end() && message->is_string() ? message->get<std::string>() : "", kWhat);
  const auto value = answer.find("Value");
  if (value == answer.end() || size_of(*value) == 0) fail("has no Value");
  const json& first = value->front();
  const bool has_planes = size_of(first) > 0 && first.front().is_array();
  const int planes = planes_of(shape, has_planes ? 3 : 2, size_of(*value), size_of(first),
                               has_planes ? size_of(first.front()) : 1);
  std::vector<double> samples;
  samples.reserve(static_cast<std::size_t>(shape.width_px) * shape.height_px * planes);
  const auto take = [&](const json& one) {
    if (!one.is_number()) fail("has a pixel that is no number");
    samples.push_back(one.get<double>());
  };
  for (const json& column : *value) {
    if (size_of(column) != shape.height_px) fail("has columns of unequal length");
    for (const json& pixel : column) {
      if (planes == 1) {
        take(pixel);
        continue;
      }
      if (size_of(pixel) != planes) fail("has pixels of unequal planes");
      for (const json& part : pixel) take(part);
    }
  }
  return frame_of(shape, planes, [&](std::size_t i) { return samples[i]; });
}

}  // namespace fathom::alpaca
