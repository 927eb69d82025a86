// SPDX-License-Identifier: Apache-2.0
// A client of an INDI server, in the caller's own thread: it reads while it is waited for, and
// never waits longer than it is told.
//
// Why not libindi's client (1.9.9)? It was tried against a server that misbehaves. A BLOB that
// never ends grows its buffer until there is no memory, and then its XML reader ends the whole
// process; nothing bounds it from outside. It reads in a thread of its own without a timeout, and
// writes to stderr. The protocol is a few XML elements; the XML is expat's.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "hal/drivers/indi/devices.hpp"
#include "hal/socket.hpp"
#include "hal/stop.hpp"

namespace fathom::indi {

using NumberWish = std::pair<std::string, double>;

enum class Waited { done, late, stopped };

class Client {
 public:
  /// Connects and asks for all properties. timeout_ns: how long an answer may take. Throws as
  /// Socket. A wish to stop ends everything below that waits, but for wait() itself, with
  /// Error(cancelled).
  Client(const Address& address, std::int64_t timeout_ns, StopRequests stop_requests = never_stop);

  const std::string& where() const { return where_; }
  std::int64_t timeout_ns() const { return timeout_ns_; }
  Devices& devices() { return devices_; }

  /// Lets pictures of a device's main chip come, up to a size.
  void want_pictures(const std::string& device, std::size_t limit_bytes);

  /// Takes in what has come already, without waiting; at most for a moment even if the server sends
  /// without end. Throws Error(device_lost) or Error(bad_data) once the connection is of no more
  /// use, here and in everything below, ever after.
  void drain();

  /// Reads until a stop is requested (null: nobody asks), a condition holds, or a time has come.
  /// The wish to stop comes first: a server that always has something to say must not hide it.
  Waited wait(const std::function<bool()>& done, std::int64_t deadline_ns,
              const StopWatch* stop = nullptr);

  /// The same, but throws Error(cancelled) if a stop is requested; false if it is late.
  bool wait_unless_stopped(const std::function<bool()>& done, std::int64_t deadline_ns);

  /// Waits until no property is defined any more for a while, at most for a time.
  void wait_until_quiet(std::int64_t quiet_ns, std::int64_t at_most_ns);

  /// A property that must be there. Throws Error(device_lost): it was there, so its driver is gone.
  const Property& need(const std::string& device, const std::string& name);

  /// Waits for a property to appear. Throws Error(timeout) if it does not.
  const Property& await(const std::string& device, const std::string& name);

  /// Asks for numbers, without waiting for an answer. Those not named are sent as they are. Throws
  /// Error(unsupported) for a value that the property has not.
  void send_numbers(const Property& property, std::span<const NumberWish> wishes);
  /// Asks for one switch to be on (or off).
  void send_switch(const Property& property, const std::string& value, bool is_on = true);

  /// Asks, and waits for the answer. Throws Error(timeout) without one, Error(unsupported) with
  /// the driver's words if it refuses. What was set instead is in the property afterwards.
  void set_numbers(const std::string& device, const std::string& name,
                   std::span<const NumberWish> wishes);
  void set_switch(const std::string& device, const std::string& name, const std::string& value);

  /// What the driver has said last, as the end of a sentence: `: "its words"`, or empty.
  std::string words_of(const std::string& device) const;

 private:
  void send(const std::string& text);
  bool read(std::int64_t deadline_ns);
  void await_answer(const std::string& device, const std::string& name, std::uint64_t before,
                    const std::function<bool(const Property&)>& is_as_wished);

  std::string where_;
  std::int64_t timeout_ns_;
  StopRequests stop_requests_;
  Socket socket_;
  XmlStream stream_;
  Devices devices_;
  std::string broken_;  // why the stream cannot be read on
};

}  // namespace fathom::indi
