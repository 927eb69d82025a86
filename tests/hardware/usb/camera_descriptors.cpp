// SPDX-License-Identifier: Apache-2.0
#include "camera_descriptors.hpp"

#include <cmath>

#include "camera_controls.hpp"

namespace fathom::usb {

namespace {

constexpr int interface_type = 4, endpoint_type = 5, association_type = 11;
constexpr int class_interface = 0x24;  // Descriptors of the video class.
constexpr int video = 14, video_control = 1, video_streaming = 2, video_collection = 3;
constexpr std::uint32_t clock_hz = 48'000'000;

// Every descriptor begins with its own length.
Bytes with_length(Bytes body) {
  body.insert(body.begin(), static_cast<std::uint8_t>(body.size() + 1));
  return body;
}

Bytes interface(int number, int endpoints, int subclass) {
  Bytes body{interface_type};
  append(body, {number, 0, endpoints, video, subclass, 0, 0});
  return with_length(body);
}

Bytes units() {
  Bytes all;
  Bytes camera{class_interface, 2, camera_terminal};
  append_number(camera, 0x0201, 2);  // A camera.
  append(camera, {0, 0});
  append(camera, {0, 0, 0, 0, 0, 0});     // No zoom.
  append(camera, {3, 0x2a, 0x00, 0x02});  // Exposure mode and time, focus, focus by itself.
  append(all, with_length(camera));
  Bytes processing{class_interface, 5, processing_unit, camera_terminal};
  append_number(processing, 0, 2);
  append(processing, {2, 0x41, 0x12, 0, 0});  // Brightness, gain, white balance and its automatic.
  append(all, with_length(processing));
  Bytes output{class_interface, 3, output_terminal};
  append_number(output, 0x0101, 2);  // USB.
  append(output, {0, processing_unit, 0});
  append(all, with_length(output));
  return all;
}

Bytes control_interface() {
  const Bytes entities = units();
  Bytes header{class_interface, 1};
  append_number(header, 0x0110, 2);
  append_number(header, static_cast<int>(13 + entities.size()), 2);
  append_number(header, clock_hz, 4);
  append(header, {1, streaming_interface});
  Bytes all = interface(0, 0, video_control);
  append(all, with_length(header));
  append(all, entities);
  return all;
}

Bytes format_descriptor(const PixelFormat& format, int index, int sizes) {
  Bytes body{class_interface, static_cast<std::uint8_t>(format.bits_per_pixel ? 4 : 6)};
  append(body, {index, sizes});
  if (format.bits_per_pixel != 0) {
    for (const char letter : format.guid) body.push_back(static_cast<std::uint8_t>(letter));
    append(body, {0, 0, 0x10, 0, 0x80, 0, 0, 0xaa, 0, 0x38, 0x9b, 0x71, format.bits_per_pixel});
  } else {
    body.push_back(0);
  }
  append(body, {1, 0, 0, 0, 0});
  return with_length(body);
}

Bytes frame_descriptor(const PixelFormat& format, int index, FrameSize size,
                       const std::vector<std::uint32_t>& intervals) {
  const std::uint32_t bytes = frame_bytes(format, size);
  const auto bits_per_s = static_cast<std::int64_t>(bytes) * 8 * 10'000'000 / intervals.front();
  Bytes body{class_interface, static_cast<std::uint8_t>(format.bits_per_pixel ? 5 : 7)};
  append(body, {index, 0});
  append_number(body, size.width_px, 2);
  append_number(body, size.height_px, 2);
  append_number(body, bits_per_s / 2, 4);
  append_number(body, bits_per_s, 4);
  append_number(body, bytes, 4);
  append_number(body, intervals.front(), 4);
  body.push_back(static_cast<std::uint8_t>(intervals.size()));
  for (const std::uint32_t interval : intervals) append_number(body, interval, 4);
  return with_length(body);
}

Bytes formats_and_sizes(const std::vector<PixelFormat>& formats,
                        const std::vector<FrameSize>& sizes, double frames_per_s) {
  const Bytes colours = with_length({class_interface, 0x0d, 1, 1, 4});
  Bytes all;
  for (std::size_t i = 0; i < formats.size(); ++i) {
    append(all,
           format_descriptor(formats[i], static_cast<int>(i + 1), static_cast<int>(sizes.size())));
    for (std::size_t k = 0; k < sizes.size(); ++k) {
      append(all, frame_descriptor(formats[i], static_cast<int>(k + 1), sizes[k],
                                   frame_intervals_100ns(frames_per_s)));
    }
    append(all, colours);
  }
  return all;
}

Bytes stream_interface(const std::vector<PixelFormat>& formats, const std::vector<FrameSize>& sizes,
                       double frames_per_s) {
  const Bytes offered = formats_and_sizes(formats, sizes, frames_per_s);
  const auto count = static_cast<int>(formats.size());
  Bytes header{class_interface, 1};
  append(header, {count});
  append_number(header, static_cast<int>(13 + formats.size() + offered.size()), 2);
  append(header, {0x80 | streaming_endpoint, 0, output_terminal, 0, 0, 0, 1});
  for (int i = 0; i < count; ++i) header.push_back(0);
  Bytes endpoint{endpoint_type};
  append(endpoint, {0x80 | streaming_endpoint, 2});
  append_number(endpoint, 512, 2);
  endpoint.push_back(0);
  Bytes all = interface(streaming_interface, 1, video_streaming);
  append(all, with_length(header));
  append(all, offered);
  append(all, with_length(endpoint));
  return all;
}

}  // namespace

std::vector<std::uint32_t> frame_intervals_100ns(double frames_per_s) {
  const auto shortest = static_cast<std::uint32_t>(std::lround(1e7 / frames_per_s));
  return {shortest, 2 * shortest, 6 * shortest};
}

std::uint32_t frame_bytes(const PixelFormat& format, FrameSize size) {
  const int bits = format.bits_per_pixel ? format.bits_per_pixel : 24;
  return static_cast<std::uint32_t>(size.width_px * size.height_px * bits / 8);
}

Bytes camera_configuration(const std::vector<PixelFormat>& formats,
                           const std::vector<FrameSize>& sizes, double frames_per_s) {
  Bytes interfaces;
  append(interfaces, with_length({association_type, 0, 2, video, video_collection, 0, 0}));
  append(interfaces, control_interface());
  append(interfaces, stream_interface(formats, sizes, frames_per_s));
  Bytes head{2};
  append_number(head, static_cast<int>(9 + interfaces.size()), 2);
  append(head, {2, 1, 0, 0x80, 50});
  Bytes all = with_length(head);
  append(all, interfaces);
  return all;
}

}  // namespace fathom::usb
