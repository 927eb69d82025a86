// SPDX-License-Identifier: Apache-2.0
// An INDI server with a camera "Cam" and a focuser "Foc" in a thread of the test, on a free port of
// 127.0.0.1, that can be told to misbehave.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "hal/drivers/indi/xml_stream.hpp"

namespace fathom::test {

/// What goes wrong, from when it is set.
enum class Fault {
  none,
  no_answer,          ///< Says nothing any more.
  no_picture,         ///< An exposure never ends.
  close_in_exposure,  ///< Hangs up in mid-exposure,
  close_in_picture,   ///< or in mid-picture.
  driver_dies,        ///< indiserver's word for a crashed driver, in mid-exposure or mid-move.
  alert,              ///< Exposures, moves and settings fail.
  short_picture,      ///< Fewer bytes than announced.
  no_base64,
  announces_gigabytes,
  endless_picture,  ///< Announces little, sends without end.
  bad_xml,          ///< In mid-exposure or mid-move.
  flood,            ///< Messages without end.
  late_busy,        ///< A motor that does not count says first that it has arrived.
  blocked,          ///< The motor does not move, its state stays busy.
  stops_short,      ///< The motor does not move, and the driver says that it is done.
  nowhere,          ///< The motor's place is nan while it moves.
  swings,           ///< The motor does not move, and its place is now 0, now 1, and busy.
};

/// Whether the focuser counts.
enum class FocuserKind { absolute, relative };

class FakeServer {
 public:
  explicit FakeServer(FocuserKind kind = FocuserKind::absolute);
  ~FakeServer();
  FakeServer(const FakeServer&) = delete;
  FakeServer& operator=(const FakeServer&) = delete;

  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  void misbehave(Fault fault) { fault_ = fault; }

  /// The bytes of the next pictures, and what the server calls their format.
  void set_picture(std::string fits, std::string format = ".fits");
  /// Has each picture made when its exposure ends, of where the motor is then.
  void paint(std::function<std::string(double motor)> make_picture);
  /// Takes a property away, or gives it a value, as if somebody else did.
  void remove(const std::string& device, const std::string& name);
  void set(const std::string& device, const std::string& name, const std::string& value,
           const std::string& text);
  /// Adds a property of one kind ("Number", "Switch", "Text") with its values.
  void add(const std::string& device, const std::string& name, const std::string& kind,
           const std::map<std::string, std::string>& values);
  std::string value(const std::string& device, const std::string& name, const std::string& value);

  /// The next requests for a property are refused.
  void refuse(const std::string& name, int times);
  /// Requests for a property are not answered.
  void ignore(const std::string& name);

  /// The motor ends so many steps farther than it is sent, and says that it is done.
  void miss(double steps);
  /// The camera tells its size, and its frame's, only after a first picture.
  void learn_size_from_picture();

  /// How often a property was asked for a change.
  int requests(const std::string& name);
  /// Where the motor is, whatever the driver says.
  double motor();
  /// The lowest place that it has been at.
  double lowest_motor();
  bool is_moving();
  bool is_exposing();

 private:
  struct Fake {
    std::string kind;
    std::string state = "Idle";
    std::map<std::string, std::string> values;
    std::string limits;
  };
  struct Client {
    int handle = -1;
    bool wants_pictures = false;
    std::unique_ptr<indi::XmlStream> stream;
  };
  using Key = std::pair<std::string, std::string>;
  using Clock = std::chrono::steady_clock;

  void put(const Key& key, const std::string& kind, std::map<std::string, std::string> values,
           const std::string& limits = "");
  void serve();
  void read_from(Client& client);
  void take(Client& client, const indi::Element& element);
  void change(const Key& key, const indi::Element& element);
  void begin_exposure();
  void begin_move(const Key& key);
  void tick();
  void finish_exposure();
  void step_motor();
  void lie_of_motor();
  void tell_size();
  void break_down();
  void send_definition(const Client& client, const Key& key);
  void send_state(const Key& key);
  void send_picture();
  void send_all(const std::string& text, bool only_pictures = false);
  void hang_up();

  std::recursive_mutex lock_;
  std::atomic<Fault> fault_ = Fault::none;
  std::atomic<bool> is_over_ = false;
  int listener_ = -1;
  int port_ = 0;
  std::vector<Client> clients_;
  std::map<Key, Fake> properties_;
  std::map<std::string, int> requests_;
  std::set<std::string> ignored_;
  std::map<std::string, int> refused_;
  std::string picture_;
  std::function<std::string(double)> make_picture_;
  std::string format_ = ".fits";
  std::optional<Clock::time_point> exposure_end_;
  double motor_ = 500;
  double lowest_motor_ = 500;
  double miss_ = 0;
  bool is_size_unknown_ = false;
  std::optional<double> target_;
  Clock::time_point move_begin_;
  std::thread thread_;
};

/// A FITS picture, made with cfitsio. type: BYTE_IMG, USHORT_IMG, ... (FITS' numbers).
std::string make_fits(int type, const std::vector<long>& sides, const std::vector<double>& pixels);

}  // namespace fathom::test
