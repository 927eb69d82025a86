// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/http/link.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <charconv>
#include <random>
#include <utility>

#include "engine/error.hpp"
#include "hal/clock.hpp"

namespace fathom::http {
namespace {

constexpr const char* kApi = "/api/v1/";
constexpr const char* kNowHeader = "x-fathom-now-ns";

/// "fathom-4711-9f3a": what others read who ask who drives.
std::string own_name() {
  std::random_device random;
  return fmt::format("fathom-{}-{:04x}", ::getpid(), random() & 0xffff);
}

std::optional<std::int64_t> time_in(const Answer& answer, const std::string& header) {
  const std::string text = answer.header(header);
  std::int64_t time = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), time);
  return problem == std::errc() && end == text.data() + text.size() ? std::optional(time)
                                                                    : std::nullopt;
}

}  // namespace

Link::Link(const LinkOptions& options)
    : options_(options), name_(own_name()), client_(options.place, name_) {
  facts_ = facts_from(get("rig").body);
  post("drive", R"({"action":"take"})");
  compare_clocks();
  is_open_ = true;
  holder_ = std::thread([this] { hold_drive(); });
}

Link::~Link() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  ends_.notify_all();
  holder_.join();
  try {
    post_unstopped("drive", R"({"action":"give"})");
  } catch (const std::exception&) {  // it is gone, or another drives: there is nothing to give
  }
}

/// What the service refuses, in the words of one who measures with its rig.
Error Link::refusal_of(const Answer& answer) const {
  const Refusal refusal = refusal_from(answer.body);
  const auto made = [&](ErrorCode code, std::string_view words) {
    return Error(code, fmt::format("the fathom serve {}: {}", where(), words));
  };
  if (refusal.code == "no_token")
    return made(ErrorCode::unavailable,
                "wants another token; give the one that it printed, as ?token=TOKEN or in "
                "FATHOM_TOKEN");
  if (refusal.code == "read_only")
    return made(ErrorCode::unavailable,
                "only shows (--read-only), so its rig cannot be used from here");
  if (refusal.code == "foreign_host")
    return made(ErrorCode::unavailable,
                fmt::format("does not know itself as {0}; start it with --name {0}",
                            options_.place.address.host));
  if (refusal.code == "not_driver")
    return made(is_open_ ? ErrorCode::device_lost : ErrorCode::unavailable,
                "somebody else drives its rig; wait, or ask whoever has its page open");
  if (refusal.code == "not_found")
    return made(ErrorCode::unavailable,
                "does not lend its rig; run the same version of Fathom at both ends");
  if (refusal.code.empty())
    return made(ErrorCode::unavailable,
                fmt::format("what answers there (status {}) is no fathom serve", answer.status));
  if (refusal.code == "busy" || refusal.code == "too_many")
    return made(ErrorCode::unavailable, refusal.message);
  return made(code_named(refusal.code), refusal.message);
}

Answer Link::ask(Request request, std::chrono::milliseconds longer,
                 const StopRequests& stop_requests) {
  request.path = kApi + request.path;
  const std::int64_t asked_ns = monotonic_now_ns();
  const std::int64_t deadline_ns =
      asked_ns + options_.timeout_ns + std::chrono::nanoseconds(longer).count();
  Answer answer = exchange(request, deadline_ns, stop_requests);
  if (answer.status >= 300) throw refusal_of(answer);
  if (const auto there_ns = time_in(answer, kNowHeader))
    clock_.add({.asked_ns = asked_ns, .there_ns = *there_ns, .answered_ns = monotonic_now_ns()});
  return answer;
}

/// A service that was there and is not any more is a device that was lost.
Answer Link::exchange(const Request& request, std::int64_t deadline_ns,
                      const StopRequests& stop_requests) {
  try {
    return client_.ask(request, deadline_ns, stop_requests);
  } catch (const Error& error) {
    const bool is_gone = error.code() == ErrorCode::unavailable ||
                         error.code() == ErrorCode::timeout || error.code() == ErrorCode::bad_data;
    if (!is_open_ || !is_gone) throw;
    throw Error(ErrorCode::device_lost, error.what());
  }
}

Answer Link::get(const std::string& path, std::size_t most_bytes,
                 std::chrono::milliseconds longer) {
  return ask({.path = path, .most_bytes = most_bytes}, longer, options_.stop_requests);
}

Answer Link::post(const std::string& path, const std::string& body) {
  return ask({.path = path, .body = body}, {}, options_.stop_requests);
}

Answer Link::get_unstopped(const std::string& path, std::chrono::milliseconds longer) {
  return ask({.path = path}, longer, never_stop);
}

Answer Link::post_unstopped(const std::string& path, const std::string& body) {
  return ask({.path = path, .body = body}, {}, never_stop);
}

void Link::compare_clocks() {
  constexpr int kTrips = 12;
  for (int i = 0; i < kTrips; ++i) get("rig/clock");
  if (options_.is_pair) clock_.freeze();
}

/// Who says nothing for 10 s counts as gone.
void Link::hold_drive() {
  constexpr std::chrono::seconds kApart{3};
  Client client(options_.place, name_);
  const Request request{.path = std::string(kApi) + "rig/clock"};
  std::unique_lock lock(mutex_);
  while (!ends_.wait_for(lock, kApart, [this] { return is_ending_; })) {
    lock.unlock();
    try {
      const StopRequests ending = [this] {
        const std::lock_guard guard(mutex_);
        return is_ending_ ? 1 : 0;
      };
      client.ask(request, monotonic_now_ns() + options_.timeout_ns, ending);
    } catch (const std::exception&) {  // whoever measures will notice
    }
    lock.lock();
  }
}

}  // namespace fathom::http
