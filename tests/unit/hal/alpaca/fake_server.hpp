// SPDX-License-Identifier: Apache-2.0
// An Alpaca server with a camera and a focuser, written from the ASCOM specifications, and what goes
// wrong with such.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace fathom::test {

struct AlpacaFaults {
  int delay_ms = 0;          ///< Before each answer.
  std::string failing = {};  ///< The property or method that answers an error,
  int error_number = 0x500;  ///< and its number.
  std::string garbled = {};  ///< The one that answers no JSON.
  bool is_another = false;   ///< Whether answers bear another transaction's number.
  int cut_bytes = 0;         ///< So many bytes of each picture are missing.
  bool never_ready = false;  ///< No exposure ends.
  bool is_stuck = false;     ///< The focuser moves, and comes nowhere.
  int status = 0;            ///< HTTP's, in place of an answer; 0: none.
};

struct AlpacaDevice {
  int width_px = 60, height_px = 40;
  int brightest = 65535;
  bool gives_bytes = true;
  bool is_colour = false;
  bool is_absolute = true;
  int travel = 1000;
  int most_at_once = 300;
  double steps_per_s = 5000;
  double longest_s = 20;  ///< Of its exposures.
};

class FakeAlpaca {
 public:
  /// A grey value of a pixel, with the focuser at a step.
  using Paint = std::function<int(int x, int y, double step)>;

  explicit FakeAlpaca(AlpacaDevice device = {}, Paint paint = {});
  ~FakeAlpaca();

  int port() const { return port_; }
  std::string rig(const std::string& keys = "") const {
    return "alpaca:127.0.0.1:" + std::to_string(port_) + keys;
  }
  void set_faults(const AlpacaFaults& faults);
  /// It answers nobody any more.
  void die();
  double step() const;
  bool is_moving() const;
  /// Values of settings, as "binx".
  double value(const std::string& name) const;
  void set_value(const std::string& name, double value);
  int requests() const { return requests_; }

 private:
  struct Http;
  struct Reply;
  void serve();
  Reply answer(const std::string& method, const std::string& what,
               const std::map<std::string, std::string>& parameters);
  Reply camera(const std::string& method, const std::string& what,
               const std::map<std::string, std::string>& parameters);
  Reply focuser(const std::string& method, const std::string& what,
                const std::map<std::string, std::string>& parameters);
  std::string picture_bytes(unsigned transaction) const;
  std::string picture_json() const;
  int pixel(int x, int y) const;
  double step_now() const;

  AlpacaDevice device_;
  Paint paint_;
  std::unique_ptr<Http> http_;
  int port_ = 0;
  std::thread thread_;
  std::atomic<int> requests_ = 0;
  mutable std::mutex mutex_;
  AlpacaFaults faults_;
  std::map<std::string, double> values_;
  double from_ = 0, to_ = 0;
  std::int64_t moving_since_ns_ = 0;
  std::int64_t ready_ns_ = 0;
  double exposed_at_step_ = 0;
};

}  // namespace fathom::test
