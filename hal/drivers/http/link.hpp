// SPDX-License-Identifier: Apache-2.0
// A connection to a service whose rig this program drives: what camera, lens and stage share.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "hal/drivers/http/client.hpp"
#include "hal/drivers/http/clock_map.hpp"
#include "hal/drivers/http/facts.hpp"
#include "hal/rig_driver.hpp"

namespace fathom::http {

struct LinkOptions {
  Place place;
  std::int64_t timeout_ns = 0;  ///< For each answer.
  /// Camera and lens are both of this service, so that one offset between the clocks serves them.
  bool is_pair = false;
  StopRequests stop_requests = never_stop;
};

/// One thread uses it. A thread of its own tells the service every few seconds that it is there.
class Link {
 public:
  /// Takes the drive. Throws Error(unavailable) where there is no such service, it refuses this
  /// program, or somebody else drives; Error(timeout), Error(bad_data), Error(cancelled).
  explicit Link(const LinkOptions& options);
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;
  /// Gives the drive back.
  ~Link();

  const std::string& where() const { return client_.where(); }
  const Facts& facts() const { return facts_; }
  /// How many pictures a recording has of the place where the lens stands.
  int recorded_here() const { return facts_.camera.recorded_here; }
  void note_recorded_here(int pictures) { facts_.camera.recorded_here = pictures; }
  const ClockMap& clock() const { return clock_; }
  const StopRequests& stop_requests() const { return options_.stop_requests; }

  // Each throws what the service answers, and Error(device_lost) where it does no more, or
  // another client drives. A wish to stop ends them with Error(cancelled).

  Answer get(const std::string& path, std::size_t most_bytes = 16 << 20,
             std::chrono::milliseconds longer = {});
  Answer post(const std::string& path, const std::string& body);
  /// Whether somebody wants it to stop or not.
  Answer get_unstopped(const std::string& path, std::chrono::milliseconds longer = {});
  Answer post_unstopped(const std::string& path, const std::string& body);

 private:
  Answer ask(Request request, std::chrono::milliseconds longer, const StopRequests& stop_requests);
  Answer exchange(const Request& request, std::int64_t deadline_ns,
                  const StopRequests& stop_requests);
  Error refusal_of(const Answer& answer) const;
  void compare_clocks();
  void hold_drive();

  LinkOptions options_;
  std::string name_;  ///< Of this client.
  Client client_;
  Facts facts_;
  ClockMap clock_;
  bool is_open_ = false;

  std::mutex mutex_;
  std::condition_variable ends_;
  bool is_ending_ = false;
  std::thread holder_;
};

}  // namespace fathom::http
