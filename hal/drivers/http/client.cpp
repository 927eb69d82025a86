// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/http/client.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "engine/error.hpp"
#include "hal/clock.hpp"

namespace fathom::http {
namespace {

constexpr std::int64_t kSlice_ns = 100'000'000;  // how soon a wish to stop is seen

Peer peer_at(const Address& address) {
  return {.address = address,
          .kind = "fathom serve",
          .advice = "start it there (fathom serve --rig RIG), or name another address"};
}

std::string host_of(const Address& address) {
  const bool is_v6 = address.host.find(':') != std::string::npos;
  return is_v6 ? fmt::format("[{}]:{}", address.host, address.port) : address.text();
}

}  // namespace

Client::Client(Place place, std::string name)
    : place_(std::move(place)), name_(std::move(name)), where_(host_of(place_.address)) {}

std::string Client::text_of(const Request& request) const {
  std::string text = fmt::format("{} {} HTTP/1.1\r\nHost: {}\r\nX-Fathom-Client: {}\r\n",
                                 request.body ? "POST" : "GET", request.path, where_, name_);
  if (!place_.token.empty()) text += fmt::format("Authorization: Bearer {}\r\n", place_.token);
  if (!request.body) return text + "\r\n";
  return text + fmt::format("Content-Type: application/json\r\nContent-Length: {}\r\n\r\n{}",
                            request.body->size(), *request.body);
}

/// Nothing where a connection that was kept turns out to be closed.
std::optional<Answer> Client::exchange(const std::string& text, const Request& request,
                                       std::int64_t deadline_ns) {
  const StopWatch stop(stop_requests_);
  const bool is_kept = socket_.has_value();
  if (!is_kept) socket_.emplace(peer_at(place_.address), deadline_ns, stop_requests_);
  AnswerReader reader(request.most_bytes);
  std::array<char, 64 << 10> room;
  try {
    socket_->send(text, deadline_ns);
    while (true) {
      const std::int64_t slice_ns = std::min(deadline_ns, monotonic_now_ns() + kSlice_ns);
      const std::size_t count = socket_->receive(room, slice_ns);
      if (auto answer = reader.add({room.data(), count})) return answer;
      if (stop.stopped()) throw Error(ErrorCode::cancelled, "stopped on request");
      if (monotonic_now_ns() < deadline_ns) continue;
      throw Error(ErrorCode::timeout,
                  fmt::format("the fathom serve {} does not answer; does it hang, or is the "
                              "network slow?",
                              where_));
    }
  } catch (const Error& error) {
    if (error.code() != ErrorCode::device_lost || !is_kept || reader.has_begun()) throw;
    return std::nullopt;
  }
}

Answer Client::ask(const Request& request, std::int64_t deadline_ns,
                   const StopRequests& stop_requests) {
  const std::string text = text_of(request);
  stop_requests_ = stop_requests;
  if (request.body) socket_.reset();  // what is done twice is asked for once
  try {
    std::optional<Answer> answer = exchange(text, request, deadline_ns);
    if (!answer) {
      socket_.reset();
      answer = exchange(text, request, deadline_ns);
    }
    if (!answer->goes_on) socket_.reset();
    return std::move(*answer);
  } catch (...) {
    socket_.reset();  // an answer may be on its way still
    throw;
  }
}

}  // namespace fathom::http
