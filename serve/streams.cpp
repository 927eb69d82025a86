// SPDX-License-Identifier: Apache-2.0
// What never ends: pictures and events.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "engine/error.hpp"
#include "hal/clock.hpp"
#include "serve/api.hpp"
#include "serve/bodies.hpp"

namespace fathom::serve {
namespace {

using std::chrono::milliseconds;

/// How long a stream may wait before it looks whether its reader is still there.
constexpr milliseconds kLookRound{250};
/// A page that hears nothing for so long is told that there is nothing.
constexpr std::int64_t kQuiet_ns = 5'000'000'000;

struct PictureStream {
  std::int64_t apart_ns = 0;
  int width = 0;
  bool is_bare = false;
  std::uint64_t seen = 0;
  std::int64_t next_ns = 0;
  bool has_begun = false;
};

constexpr const char* kBoundary = "--fathom\r\n";
constexpr const char* kBareHead = "Content-Type: image/jpeg\r\n\r\n";

std::string head_of(const Picture& picture, std::size_t bytes) {
  std::string head =
      fmt::format("Content-Type: image/jpeg\r\nContent-Length: {}\r\nX-Fathom-Stamp-Ns: {}\r\n",
                  bytes, picture.frame().exposure.start_ns);
  if (picture.position) head += fmt::format("X-Fathom-Position: {:.17g}\r\n", *picture.position);
  return head + "\r\n";
}

/// Browsers show a picture when they have read the head of the next one. That of a bare stream is
/// known before, and follows at once.
std::string part_of(const Picture& picture, const PictureStream& stream) {
  const auto jpeg = picture.jpeg(stream.width);
  std::string part = stream.has_begun ? "" : kBoundary;
  if (!stream.is_bare) part += head_of(picture, jpeg->size());
  if (stream.is_bare && !stream.has_begun) part += kBareHead;
  return part + *jpeg + "\r\n" + kBoundary + (stream.is_bare ? kBareHead : "");
}

/// One that comes now, rather than one that has been there for a while; that where none comes.
std::shared_ptr<const Picture> freshest(PictureFeed& pictures, std::uint64_t seen) {
  const auto newest = pictures.newest();
  const bool is_late = newest && newest->number() > seen;
  constexpr std::chrono::milliseconds kWorthWaiting{
      40};  // for the next one of a camera that streams
  const auto fresh =
      is_late ? pictures.next(newest->number(), kWorthWaiting) : pictures.next(seen, kLookRound);
  return fresh || !is_late ? fresh : newest;
}

/// One part, or none for a while. Whether the stream goes on.
bool send_picture(PictureFeed& pictures, PictureStream& stream, httplib::DataSink& sink) {
  const std::int64_t now = monotonic_now_ns();
  if (now < stream.next_ns) {
    const std::int64_t look_round = std::chrono::nanoseconds(kLookRound).count();
    sleep_until_ns(std::min(stream.next_ns, now + look_round));
    return !pictures.is_closed();
  }
  const auto picture = freshest(pictures, stream.seen);
  if (!picture) return !pictures.is_closed();
  stream.seen = picture->number();
  stream.next_ns = monotonic_now_ns() + stream.apart_ns;
  const std::string part = part_of(*picture, stream);
  stream.has_begun = true;
  return sink.write(part.data(), part.size());
}

}  // namespace

void Api::begin_stream() {
  if (++streams_ <= kMostStreams) return;
  --streams_;
  throw TooMany();
}

void Api::stream_pictures(const httplib::Request& request, httplib::Response& response) {
  constexpr double kUsual = 30, kLeast = 0.1, kMost = 100, kWidest = 65536, kSecond = 1e9;
  constexpr double kEarly = 0.8;  // a picture that comes a little early is not left out
  auto stream = std::make_shared<PictureStream>();
  const double fps = number_from("fps", request.get_param_value("fps"), kUsual, kLeast, kMost);
  stream->apart_ns = static_cast<std::int64_t>(kEarly * kSecond / fps);
  stream->width =
      static_cast<int>(number_from("width", request.get_param_value("width"), 0, 0, kWidest));
  stream->is_bare = number_from("bare", request.get_param_value("bare"), 0, 0, 1) > 0;
  begin_stream();
  publisher_.pictures.add_watcher(1);
  response.set_chunked_content_provider(
      "multipart/x-mixed-replace; boundary=fathom",
      [this, stream](std::size_t, httplib::DataSink& sink) {
        return send_picture(publisher_.pictures, *stream, sink);
      },
      [this](bool) {
        publisher_.pictures.add_watcher(-1);
        --streams_;
      });
}

std::string Api::event_text(const Event& event, const std::string& client) const {
  std::string data = event.data;
  if (event.kind == "state") {
    data = fmt::format("{{{},\"drive\":{},\"clients\":{}}}", event.data, drive_json(client),
                       publisher_.events.readers());
  } else if (event.kind == "drive") {
    data = drive_json(client);
  }
  return fmt::format("id: {}\nevent: {}\ndata: {}\n\n", event.id, event.kind, data);
}

/// What this reader has not heard, as text; nothing where it was too slow, or all is over.
std::optional<std::string> Api::news_for(EventReader& reader) {
  std::string text;
  if (!std::exchange(reader.has_begun, true)) {
    reader.next = publisher_.events.next();
    return event_text({reader.next - 1, "state", publisher_.board.read(state_members)},
                      reader.client);
  }
  notice_driver();
  const auto events = publisher_.events.read(reader.next, kLookRound);
  if (!events || (events->empty() && publisher_.events.is_closed())) return std::nullopt;
  for (const Event& event : *events) text += event_text(event, reader.client);
  reader.next += events->size();
  return text;
}

bool Api::send_events(EventReader& reader, httplib::DataSink& sink) {
  constexpr milliseconds kGathering{50};  // many small pieces would cost more than they tell
  std::optional<std::string> text = news_for(reader);
  if (!text) return false;
  const std::int64_t now = monotonic_now_ns();
  if (text->empty() && now - reader.told_ns > kQuiet_ns) text = ": quiet\n\n";
  if (text->empty()) return true;
  reader.told_ns = now;
  const bool goes_on = sink.write(text->data(), text->size());
  std::this_thread::sleep_for(kGathering);
  return goes_on;
}

void Api::add_event_reader(const std::string& client, int change) {
  {
    const std::lock_guard lock(drive_mutex_);
    change > 0 ? drive_.opened(client) : drive_.closed(client);
  }
  publisher_.events.add_reader(change);
}

void Api::stream_events(const httplib::Request& request, httplib::Response& response) {
  auto reader = std::make_shared<EventReader>();
  reader->client = client_of(request);
  begin_stream();
  add_event_reader(reader->client, 1);
  response.set_chunked_content_provider(
      "text/event-stream",
      [this, reader](std::size_t, httplib::DataSink& sink) { return send_events(*reader, sink); },
      [this, reader](bool) {
        add_event_reader(reader->client, -1);
        --streams_;
      });
}

}  // namespace fathom::serve
