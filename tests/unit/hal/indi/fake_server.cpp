// SPDX-License-Identifier: Apache-2.0
#include "fake_server.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "engine/error.hpp"

namespace fathom::test {
namespace {

using namespace std::chrono_literals;

constexpr double kStepsPerTick = 20;  // a tick is two milliseconds

}  // namespace

FakeServer::FakeServer(FocuserKind kind) {
  for (const char* device : {"Cam", "Foc"}) {
    put({device, "CONNECTION"}, "Switch", {{"CONNECT", "Off"}, {"DISCONNECT", "On"}});
    put({device, "DRIVER_INFO"}, "Text",
        {{"DRIVER_INTERFACE", std::string(device) == "Cam" ? "2" : "8"}});
    put({device, "POLLING_PERIOD"}, "Number", {{"PERIOD_MS", "1000"}});
  }
  put({"Cam", "CCD_EXPOSURE"}, "Number", {{"CCD_EXPOSURE_VALUE", "1"}}, "min='0.001' max='3600'");
  put({"Cam", "CCD_ABORT_EXPOSURE"}, "Switch", {{"ABORT", "Off"}});
  put({"Cam", "CCD_INFO"}, "Number",
      {{"CCD_MAX_X", "64"}, {"CCD_MAX_Y", "48"}, {"CCD_BITSPERPIXEL", "16"}});
  put({"Cam", "CCD_FRAME"}, "Number", {{"X", "0"}, {"Y", "0"}, {"WIDTH", "64"}, {"HEIGHT", "48"}});
  put({"Cam", "CCD_BINNING"}, "Number", {{"HOR_BIN", "1"}, {"VER_BIN", "1"}}, "min='1' max='4'");
  put({"Cam", "CCD_COMPRESSION"}, "Switch", {{"INDI_ENABLED", "On"}, {"INDI_DISABLED", "Off"}});
  put({"Cam", "UPLOAD_MODE"}, "Switch", {{"UPLOAD_CLIENT", "Off"}, {"UPLOAD_LOCAL", "On"}});
  put({"Cam", "CCD1"}, "BLOB", {{"CCD1", ""}});
  put({"Foc", "FOCUS_ABORT_MOTION"}, "Switch", {{"ABORT", "Off"}});
  put({"Foc", "FOCUS_MAX"}, "Number", {{"FOCUS_MAX_VALUE", "1000"}});
  if (kind == FocuserKind::absolute) {
    put({"Foc", "ABS_FOCUS_POSITION"}, "Number", {{"FOCUS_ABSOLUTE_POSITION", "500"}},
        "min='0' max='2000'");
  } else {
    put({"Foc", "REL_FOCUS_POSITION"}, "Number", {{"FOCUS_RELATIVE_POSITION", "0"}},
        "min='0' max='300'");
    put({"Foc", "FOCUS_MOTION"}, "Switch", {{"FOCUS_INWARD", "On"}, {"FOCUS_OUTWARD", "Off"}});
  }
  listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof at;
  if (bind(listener_, reinterpret_cast<sockaddr*>(&at), size) != 0 || listen(listener_, 8) != 0 ||
      getsockname(listener_, reinterpret_cast<sockaddr*>(&at), &size) != 0) {
    throw Error(ErrorCode::io, "the test's server cannot listen on 127.0.0.1");
  }
  port_ = ntohs(at.sin_port);
  thread_ = std::thread([this] { serve(); });
}

FakeServer::~FakeServer() {
  is_over_ = true;
  thread_.join();
  hang_up();
  close(listener_);
}

void FakeServer::put(const Key& key, const std::string& kind,
                     std::map<std::string, std::string> values, const std::string& limits) {
  properties_[key] = {kind, "Idle", std::move(values), limits};
}

void FakeServer::add(const std::string& device, const std::string& name, const std::string& kind,
                     const std::map<std::string, std::string>& values) {
  const std::lock_guard guard(lock_);
  put({device, name}, kind, values);
  for (const Client& client : clients_) send_definition(client, {device, name});
}

void FakeServer::set_picture(std::string fits, std::string format) {
  const std::lock_guard guard(lock_);
  picture_ = std::move(fits);
  format_ = std::move(format);
}

void FakeServer::paint(std::function<std::string(double motor)> make_picture) {
  const std::lock_guard guard(lock_);
  make_picture_ = std::move(make_picture);
}

void FakeServer::remove(const std::string& device, const std::string& name) {
  const std::lock_guard guard(lock_);
  properties_.erase({device, name});
  send_all(fmt::format("<delProperty device='{}' name='{}'/>", device, name));
}

void FakeServer::set(const std::string& device, const std::string& name, const std::string& value,
                     const std::string& text) {
  const std::lock_guard guard(lock_);
  properties_.at({device, name}).values[value] = text;
  if (value == "FOCUS_ABSOLUTE_POSITION") motor_ = std::stod(text);
  send_state({device, name});
}

std::string FakeServer::value(const std::string& device, const std::string& name,
                              const std::string& value) {
  const std::lock_guard guard(lock_);
  return properties_.at({device, name}).values.at(value);
}

void FakeServer::refuse(const std::string& name, int times) {
  const std::lock_guard guard(lock_);
  refused_[name] = times;
}

void FakeServer::ignore(const std::string& name) {
  const std::lock_guard guard(lock_);
  ignored_.insert(name);
}

void FakeServer::miss(double steps) {
  const std::lock_guard guard(lock_);
  miss_ = steps;
}

void FakeServer::learn_size_from_picture() {
  const std::lock_guard guard(lock_);
  is_size_unknown_ = true;
  for (const char* value : {"CCD_MAX_X", "CCD_MAX_Y"})
    properties_.at({"Cam", "CCD_INFO"}).values[value] = "0";
  for (const char* value : {"WIDTH", "HEIGHT"})
    properties_.at({"Cam", "CCD_FRAME"}).values[value] = "0";
}

void FakeServer::tell_size() {
  is_size_unknown_ = false;
  auto& info = properties_.at({"Cam", "CCD_INFO"}).values;
  auto& frame = properties_.at({"Cam", "CCD_FRAME"}).values;
  info["CCD_MAX_X"] = frame["WIDTH"] = "64";
  info["CCD_MAX_Y"] = frame["HEIGHT"] = "48";
  send_state({"Cam", "CCD_INFO"});
  send_state({"Cam", "CCD_FRAME"});
}

int FakeServer::requests(const std::string& name) {
  const std::lock_guard guard(lock_);
  return requests_[name];
}

double FakeServer::motor() {
  const std::lock_guard guard(lock_);
  return motor_;
}

double FakeServer::lowest_motor() {
  const std::lock_guard guard(lock_);
  return lowest_motor_;
}

bool FakeServer::is_moving() {
  const std::lock_guard guard(lock_);
  return target_.has_value();
}

bool FakeServer::is_exposing() {
  const std::lock_guard guard(lock_);
  return exposure_end_.has_value();
}

void FakeServer::change(const Key& key, const indi::Element& element) {
  Fake& fake = properties_[key];
  const double before = motor_;
  if (fault_ == Fault::alert || refused_[key.second] > 0) {
    --refused_[key.second];
    fake.state = "Alert";
    send_all(fmt::format("<message device='{}' message='it smokes'/>", key.first));
    return send_state(key);
  }
  fake.state = "Ok";
  if (fake.kind == "Switch" && element.members.at(0).text == "On") {
    for (auto& [name, text] : fake.values) text = "Off";
  }
  for (const indi::Member& member : element.members) {
    if (key.second != "ABS_FOCUS_POSITION") fake.values[member.attribute("name")] = member.text;
  }
  if (key.second == "CCD_EXPOSURE") begin_exposure();
  if (key.second == "CCD_ABORT_EXPOSURE" && exposure_end_) {
    exposure_end_.reset();
    properties_[{"Cam", "CCD_EXPOSURE"}].state = "Idle";
    send_state({"Cam", "CCD_EXPOSURE"});
  }
  if (key.second == "ABS_FOCUS_POSITION") {
    const double wanted = std::stod(element.members.at(0).text);
    target_ = wanted == motor_ ? wanted : wanted + miss_;
  }
  if (key.second == "REL_FOCUS_POSITION") {
    const bool inward = properties_[{"Foc", "FOCUS_MOTION"}].values["FOCUS_INWARD"] == "On";
    const double steps = std::stod(element.members.at(0).text);
    target_ = std::max(0.0, before + (inward ? -steps : steps));  // its stop holds it at 0
  }
  if (key.second.ends_with("_FOCUS_POSITION") && fault_ != Fault::late_busy) fake.state = "Busy";
  move_begin_ = Clock::now() + (fault_ == Fault::late_busy ? 40ms : 0ms);
  if (key.second == "FOCUS_ABORT_MOTION") {
    target_.reset();
    for (auto& [name, other] : properties_) {
      if (!name.second.ends_with("_FOCUS_POSITION")) continue;
      other.state = "Idle";
      send_state(name);
    }
  }
  send_state(key);
}

void FakeServer::begin_exposure() {
  Fake& exposure = properties_[{"Cam", "CCD_EXPOSURE"}];
  exposure.state = "Busy";
  const double seconds = std::stod(exposure.values["CCD_EXPOSURE_VALUE"]);
  exposure_end_ = Clock::now() + std::chrono::microseconds(std::lround(seconds * 1e6));
}

void FakeServer::tick() {
  if (fault_ == Fault::flood) {
    for (int i = 0; i < 100; ++i) send_all("<message device='Cam' message='and another thing'/>");
  }
  if (exposure_end_ || target_) break_down();
  if (target_ && (fault_ == Fault::swings || fault_ == Fault::stops_short)) lie_of_motor();
  if (target_ && fault_ != Fault::blocked && fault_ != Fault::no_answer &&
      fault_ != Fault::swings) {
    step_motor();
  }
  if (exposure_end_ && Clock::now() >= *exposure_end_ && fault_ != Fault::no_picture &&
      fault_ != Fault::no_answer) {
    exposure_end_.reset();
    properties_[{"Cam", "CCD_EXPOSURE"}].state = "Ok";
    if (make_picture_) picture_ = make_picture_(motor_);
    send_picture();
    send_state({"Cam", "CCD_EXPOSURE"});
    if (is_size_unknown_) tell_size();
  }
}

/// What happens in the middle of something.
void FakeServer::break_down() {
  if (fault_ == Fault::close_in_exposure) {
    exposure_end_.reset();
    properties_[{"Cam", "CCD_EXPOSURE"}].state = "Idle";
    hang_up();
  }
  if (fault_ == Fault::bad_xml) send_all("<setNumberVector device=\"C<<& am\">");
  if (fault_ == Fault::driver_dies) {
    exposure_end_.reset();
    target_.reset();
    send_all("<delProperty device='Cam'/><delProperty device='Foc'/>");
  }
}

void FakeServer::lie_of_motor() {
  Fake& fake = properties_.at({"Foc", "ABS_FOCUS_POSITION"});
  std::string& place = fake.values["FOCUS_ABSOLUTE_POSITION"];
  if (fault_ == Fault::swings) {
    place = place == "0" ? "1" : "0";
  } else {
    target_.reset();
    fake.state = "Ok";
  }
  send_state({"Foc", "ABS_FOCUS_POSITION"});
}

void FakeServer::step_motor() {
  if (Clock::now() < move_begin_) return;
  const double way = *target_ - motor_;
  motor_ += std::clamp(way, -kStepsPerTick, kStepsPerTick);
  lowest_motor_ = std::min(lowest_motor_, motor_);
  const bool arrived = motor_ == *target_;
  if (arrived) target_.reset();
  for (auto& [key, fake] : properties_) {
    if (!key.second.ends_with("_FOCUS_POSITION")) continue;
    if (key.second == "ABS_FOCUS_POSITION") {
      fake.values["FOCUS_ABSOLUTE_POSITION"] =
          fault_ == Fault::nowhere ? "nan" : fmt::format("{}", motor_);
    }
    fake.state = arrived ? "Ok" : "Busy";
    send_state(key);
  }
}

}  // namespace fathom::test
