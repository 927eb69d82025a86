// SPDX-License-Identifier: Apache-2.0
#include "fake_server.hpp"

#include <httplib.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "hal/clock.hpp"

namespace fathom::test {

using nlohmann::json;

struct FakeAlpaca::Http {
  httplib::Server server;
};

/// The Value of an answer, an error, or a picture.
struct FakeAlpaca::Reply {
  json value = nullptr;
  int error = 0;
  bool is_picture = false;
  bool is_unknown = false;
};

namespace {

constexpr int kNotImplemented = 0x400, kInvalidValue = 0x401, kInvalidOperation = 0x40B;

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// How ASCOM spells the parameter that sets a property. Servers may insist on it, and this one does.
const std::map<std::string, std::string> kSpelled = {
    {"binx", "BinX"}, {"biny", "BinY"}, {"startx", "StartX"}, {"starty", "StartY"},
    {"numx", "NumX"}, {"numy", "NumY"}, {"gain", "Gain"}};

void add_int(std::string& bytes, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> 8 * i & 255);
}

}  // namespace

FakeAlpaca::FakeAlpaca(AlpacaDevice device, Paint paint)
    : device_(device),
      paint_(paint ? std::move(paint) : [](int x, int y, double) { return 10 * x + y; }),
      http_(std::make_unique<Http>()) {
  values_ = {{"binx", 1},
             {"biny", 1},
             {"startx", 0},
             {"starty", 0},
             {"gain", 5},
             {"tempcomp", 1},
             {"connected", 0},
             {"numx", device.width_px},
             {"numy", device.height_px}};
  http_->server.set_tcp_nodelay(true);
  serve();
  port_ = http_->server.bind_to_any_port("127.0.0.1");
  thread_ = std::thread([this] { http_->server.listen_after_bind(); });
  while (!http_->server.is_running()) std::this_thread::yield();
}

FakeAlpaca::~FakeAlpaca() { die(); }

void FakeAlpaca::die() {
  http_->server.stop();
  if (thread_.joinable()) thread_.join();
}

void FakeAlpaca::set_faults(const AlpacaFaults& faults) {
  const std::scoped_lock lock(mutex_);
  faults_ = faults;
}

double FakeAlpaca::step() const {
  const std::scoped_lock lock(mutex_);
  return step_now();
}

bool FakeAlpaca::is_moving() const {
  const std::scoped_lock lock(mutex_);
  return step_now() != to_;
}

double FakeAlpaca::value(const std::string& name) const {
  const std::scoped_lock lock(mutex_);
  return values_.at(name);
}

void FakeAlpaca::set_value(const std::string& name, double value) {
  const std::scoped_lock lock(mutex_);
  values_[name] = value;
}

double FakeAlpaca::step_now() const {
  if (faults_.is_stuck && from_ != to_) return from_;
  const double gone =
      static_cast<double>(monotonic_now_ns() - moving_since_ns_) * 1e-9 * device_.steps_per_s;
  return std::abs(to_ - from_) <= gone ? to_ : from_ + std::copysign(gone, to_ - from_);
}

int FakeAlpaca::pixel(int x, int y) const {
  const int grey = paint_(x + static_cast<int>(values_.at("startx")),
                          y + static_cast<int>(values_.at("starty")), exposed_at_step_);
  return std::clamp(grey, 0, device_.brightest);
}

std::string FakeAlpaca::picture_bytes(unsigned transaction) const {
  const auto width = static_cast<int>(values_.at("numx")),
             height = static_cast<int>(values_.at("numy"));
  const bool is_byte = device_.brightest <= 255;
  std::string bytes;
  for (const std::uint32_t word :
       {1u, 0u, transaction, 7u, 44u, 2u, is_byte ? 6u : 8u, device_.is_colour ? 3u : 2u,
        static_cast<unsigned>(width), static_cast<unsigned>(height), device_.is_colour ? 3u : 0u})
    add_int(bytes, word);
  for (int x = 0; x < width; ++x) {
    for (int y = 0; y < height; ++y) {
      for (int plane = 0; plane < (device_.is_colour ? 3 : 1); ++plane) {
        const int grey = pixel(x, y);
        bytes += static_cast<char>(grey & 255);
        if (!is_byte) bytes += static_cast<char>(grey >> 8);
      }
    }
  }
  bytes.resize(bytes.size() - static_cast<std::size_t>(faults_.cut_bytes));
  return bytes;
}

std::string FakeAlpaca::picture_json() const {
  json columns = json::array();
  for (int x = 0; x < values_.at("numx"); ++x) {
    json column = json::array();
    for (int y = 0; y < values_.at("numy"); ++y) {
      const int grey = pixel(x, y);
      column.push_back(device_.is_colour ? json{grey, grey, grey} : json(grey));
    }
    columns.push_back(column);
  }
  if (faults_.cut_bytes > 0) columns.back().erase(0);
  return json{{"Type", 2},
              {"Rank", device_.is_colour ? 3 : 2},
              {"Value", columns},
              {"ErrorNumber", 0},
              {"ErrorMessage", ""}}
      .dump();
}

FakeAlpaca::Reply FakeAlpaca::camera(const std::string& method, const std::string& what,
                                     const std::map<std::string, std::string>& parameters) {
  if (what == "name") return {"Sky Camera"};
  if (what == "maxadu") return {device_.brightest};
  if (what == "cameraxsize") return {device_.width_px};
  if (what == "cameraysize") return {device_.height_px};
  if (what == "maxbinx" || what == "maxbiny") return {4};
  if (what == "exposuremin") return {0.001};
  if (what == "exposuremax") return {device_.longest_s};
  if (what == "canabortexposure") return {true};
  if (what == "camerastate") return {ready_ns_ != 0 ? 2 : 0};
  if (what == "imageready")
    return {ready_ns_ != 0 && !faults_.never_ready && monotonic_now_ns() >= ready_ns_};
  if (what == "imagearray") {
    if (ready_ns_ == 0) return {nullptr, kInvalidOperation};
    Reply reply;
    reply.is_picture = true;
    return reply;
  }
  if (what == "abortexposure" && method == "PUT") return ready_ns_ = 0, Reply{};
  if (what == "startexposure" && method == "PUT") {
    ready_ns_ =
        monotonic_now_ns() + static_cast<std::int64_t>(std::stod(parameters.at("Duration")) * 1e9);
    exposed_at_step_ = step_now();
    return {};
  }
  const auto known = values_.find(what);
  if (known == values_.end()) return {nullptr, kNotImplemented};
  if (method == "GET") return {known->second};
  const double wished = std::stod(parameters.at(kSpelled.at(what)));
  if (wished < 0) return {nullptr, kInvalidValue};
  known->second = wished;
  return {};
}

FakeAlpaca::Reply FakeAlpaca::focuser(const std::string& method, const std::string& what,
                                      const std::map<std::string, std::string>& parameters) {
  if (what == "name") return {"Focus Motor"};
  if (what == "absolute") return {device_.is_absolute};
  if (what == "maxstep") return {device_.travel};
  if (what == "maxincrement") return {device_.most_at_once};
  if (what == "tempcompavailable") return {true};
  if (what == "tempcomp") {
    if (method == "GET") return {values_.at("tempcomp") != 0};
    values_["tempcomp"] = lower(parameters.at("TempComp")) == "true" ? 1 : 0;
    return {};
  }
  if (what == "position") {
    if (!device_.is_absolute) return {nullptr, kNotImplemented};
    return {std::lround(step_now())};
  }
  if (what == "ismoving") return {step_now() != to_};
  if (what == "halt" && method == "PUT") {
    from_ = to_ = step_now();
    return {};
  }
  if (what != "move" || method != "PUT") return {nullptr, kNotImplemented};
  const double from = step_now(), wished = std::stod(parameters.at("Position"));
  const double to =
      device_.is_absolute ? wished : std::clamp(from + wished, 0.0, 1.0 * device_.travel);
  if (to < 0 || to > device_.travel ||
      std::abs(device_.is_absolute ? to - from : wished) > device_.most_at_once)
    return {nullptr, kInvalidValue};
  from_ = from;
  to_ = to;
  moving_since_ns_ = monotonic_now_ns();
  return {};
}

FakeAlpaca::Reply FakeAlpaca::answer(const std::string& method, const std::string& what,
                                     const std::map<std::string, std::string>& parameters) {
  const std::size_t slash = what.rfind('/');
  const std::string device = what.substr(0, slash), name = what.substr(slash + 1);
  if (faults_.failing == name) return {nullptr, faults_.error_number};
  if (name == "connected") {
    if (method == "GET") return {values_.at("connected") != 0};
    values_["connected"] = lower(parameters.at("Connected")) == "true" ? 1 : 0;
    return {};
  }
  if (device == "camera/0") return camera(method, name, parameters);
  if (device == "focuser/0") return focuser(method, name, parameters);
  Reply unknown;
  unknown.is_unknown = true;
  return unknown;
}

void FakeAlpaca::serve() {
  const auto handle = [this](const httplib::Request& request, httplib::Response& response) {
    ++requests_;
    std::unique_lock lock(mutex_);
    const AlpacaFaults faults = faults_;
    if (faults.delay_ms > 0) {
      lock.unlock();
      sleep_until_ns(monotonic_now_ns() + faults.delay_ms * 1'000'000LL);
      lock.lock();
    }
    std::map<std::string, std::string> parameters;
    for (const auto& [key, value] : request.params) parameters[key] = value;
    const unsigned transaction =
        static_cast<unsigned>(std::stoul(parameters.at("ClientTransactionID"))) +
        (faults.is_another ? 1u : 0u);
    const std::string path = request.path;
    const std::string name = path.substr(path.rfind('/') + 1);
    if (faults.status != 0) {
      response.status = faults.status;
      return response.set_content("out of order", "text/plain");
    }
    if (faults.garbled == name) return response.set_content("<html>", "text/html");
    Reply reply;
    if (path == "/management/v1/configureddevices") {
      reply.value = json::array(
          {{{"DeviceName", "Sky Camera"}, {"DeviceType", "Camera"}, {"DeviceNumber", 0}},
           {{"DeviceName", "Focus Motor"}, {"DeviceType", "Focuser"}, {"DeviceNumber", 0}},
           {{"DeviceName", "Dome"}, {"DeviceType", "Dome"}, {"DeviceNumber", 0}}});
    } else {
      reply = answer(request.method, path.substr(std::string("/api/v1/").size()), parameters);
    }
    if (reply.is_unknown) {
      response.status = 400;
      return response.set_content("no such device", "text/plain");
    }
    if (reply.is_picture) {
      ready_ns_ = 0;
      const bool wants_bytes =
          request.get_header_value("Accept").find("application/imagebytes") != std::string::npos;
      if (wants_bytes && device_.gives_bytes)
        return response.set_content(picture_bytes(transaction), "application/imagebytes");
      return response.set_content(picture_json(), "application/json");
    }
    const json body{{"Value", reply.value},
                    {"ClientTransactionID", transaction},
                    {"ServerTransactionID", requests_.load()},
                    {"ErrorNumber", reply.error},
                    {"ErrorMessage", reply.error == 0 ? "" : "it does not want to"}};
    response.set_content(body.dump(), "application/json");
  };
  http_->server.Get("/.*", handle);
  http_->server.Put("/.*", handle);
}

}  // namespace fathom::test
