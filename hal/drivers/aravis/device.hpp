// SPDX-License-Identifier: Apache-2.0
// A camera that Aravis has opened, which its camera and its lens share: who controls a GigE camera is
// one program, and in it one connection.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "hal/drivers/aravis/api.hpp"
#include "hal/restorer.hpp"

namespace fathom::aravis {

/// Both ends of a feature's range, and how it goes from one to the next; 0 where it does not say.
struct Range {
  double lowest = 0;
  double highest = 0;
  double step = 0;
};

class Device {
 public:
  /// name: an ID, serial number or address; empty: the only camera there is. Throws
  /// Error(unavailable), Error(bad_argument) where there are several.
  static std::shared_ptr<Device> open(const std::string& name);
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  ~Device();

  const std::string& name() const { return name_; }
  const std::string& model() const { return model_; }
  ArvCamera* camera() const { return camera_; }

  /// Once it does not answer, nothing more is asked of it: each question would wait for seconds.
  bool is_lost() const { return lost_->load(); }
  /// Gives up an object of Aravis' that belongs to this camera. Of one that has gone Aravis asks for some
  /// ten seconds to let go: a thread waits for that, and is left behind.
  void let_go(void* object) const noexcept;
  /// Throws Error(device_lost).
  [[noreturn]] void fail_lost() const;

  /// Calls `question` with the place for Aravis' error. doing: the end of "cannot ...". Throws
  /// Error(device_lost), Error(unavailable) where another program controls it, Error(unsupported).
  template <class Question>
  auto ask(const std::string& doing, Question question) const {
    if (is_lost()) fail_lost();
    GError* error = nullptr;
    if constexpr (std::is_void_v<decltype(question(&error))>) {
      question(&error);
      if (error != nullptr) fail(error, doing);
    } else {
      auto answer = question(&error);
      if (error != nullptr) fail(error, doing);
      return answer;
    }
  }

  /// Whether it has a feature that can be used as it stands.
  bool has(const std::string& feature) const;
  bool has_choice(const std::string& feature, const std::string& choice) const;
  std::string text(const std::string& feature) const;
  void set_text(const std::string& feature, const std::string& value) const;
  std::int64_t integer(const std::string& feature) const;
  void set_integer(const std::string& feature, std::int64_t value) const;
  Range integer_range(const std::string& feature) const;
  double number(const std::string& feature) const;
  void set_number(const std::string& feature, double value) const;
  Range number_range(const std::string& feature) const;
  void execute(const std::string& command) const;

 private:
  Device(ArvCamera* camera, std::string name);
  [[noreturn]] void fail(GError* error, const std::string& doing) const;

  ArvCamera* camera_;
  std::string name_;
  std::string model_;
  /// Aravis' own thread tells of a loss.
  std::shared_ptr<std::atomic<bool>> lost_;
};

/// Of a camera's features.
class FeatureRestorer : public Restorer {
 public:
  explicit FeatureRestorer(std::shared_ptr<Device> device) : device_(std::move(device)) {}

  /// Sets a feature that has words for values, if it has this one and has not it already.
  void set_text(const std::string& feature, const std::string& value);

 private:
  std::shared_ptr<Device> device_;
};

}  // namespace fathom::aravis
