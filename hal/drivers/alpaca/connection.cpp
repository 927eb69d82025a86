// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/alpaca/connection.hpp"

#include <fmt/format.h>
#include <httplib.h>

#include <algorithm>
#include <cctype>

#include "engine/error.hpp"
#include "hal/clock.hpp"

namespace fathom::alpaca {
namespace {

using nlohmann::json;

constexpr std::int64_t kMicrosecond_ns = 1000;
constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::size_t kMostBytes = 1 << 20;
/// By which a server tells its clients apart.
constexpr int kClient = 7221;
constexpr const char* kImageBytes = "application/imagebytes";

// ASCOM's error numbers.
constexpr int kNotImplemented = 0x400, kNotConnected = 0x407;

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// What a server says is quoted, and not at length.
std::string shortened(std::string_view text) {
  constexpr std::size_t kLongest = 200;
  return std::string(text.substr(0, kLongest));
}

}  // namespace

void require_no_error(long long number, std::string_view message, const std::string& what) {
  if (number == 0) return;
  const std::string why =
      fmt::format("{}: {} (Alpaca error {:#x})", what, shortened(message), number);
  if (number == kNotConnected) throw Error(ErrorCode::device_lost, why);
  if (number == kNotImplemented)
    throw Error(ErrorCode::unsupported, why + "; its driver has not got that");
  throw Error(ErrorCode::unsupported, why);
}

Connection::Connection(const Address& address, std::int64_t timeout_ns)
    : address_(address),
      timeout_ns_(timeout_ns),
      client_(std::make_unique<httplib::Client>(address.host, std::stoi(address.port))) {
  const auto seconds = static_cast<time_t>(timeout_ns / kSecond_ns);
  const auto rest_us = static_cast<time_t>(timeout_ns % kSecond_ns / kMicrosecond_ns);
  client_->set_connection_timeout(seconds, rest_us);
  client_->set_read_timeout(seconds, rest_us);
  client_->set_write_timeout(seconds, rest_us);
  client_->set_keep_alive(true);
  client_->set_tcp_nodelay(true);
}

Connection::~Connection() = default;

std::string Connection::numbers() {
  return fmt::format("ClientID={}&ClientTransactionID={}", kClient, ++transaction_);
}

Connection::Answer Connection::ask(httplib::Request& request, std::size_t most_bytes) {
  const std::int64_t deadline_ns = monotonic_now_ns() + timeout_ns_;
  Answer answer;
  bool is_too_long = false, is_late = false;
  request.content_receiver = [&](const char* data, std::size_t size, std::uint64_t, std::uint64_t) {
    is_too_long = answer.body.size() + size > most_bytes;
    is_late = monotonic_now_ns() > deadline_ns;  // one that sends byte after byte has no end
    if (is_too_long || is_late) return false;
    answer.body.append(data, size);
    return true;
  };
  const std::string what =
      fmt::format("{} of {}", request.path.substr(0, request.path.find('?')), address_.text());
  const httplib::Result result = client_->send(request);
  if (is_too_long) {
    throw Error(ErrorCode::bad_data,
                fmt::format("{}: more than {} bytes, where none can be", what, most_bytes));
  }
  if (is_late ||
      (!result && result.error() == httplib::Error::Read && monotonic_now_ns() >= deadline_ns)) {
    throw Error(ErrorCode::timeout,
                fmt::format("{}: no answer within {:g} s; timeout_s=SECONDS waits longer", what,
                            static_cast<double>(timeout_ns_) / kSecond_ns));
  }
  if (!result) {
    throw Error(has_answered_ ? ErrorCode::device_lost : ErrorCode::unavailable,
                fmt::format("no answer from the Alpaca server {}: {}; does it run, and is its "
                            "address right?",
                            address_.text(), httplib::to_string(result.error())));
  }
  has_answered_ = true;
  if (result->status != 200) {
    throw Error(ErrorCode::unsupported, fmt::format("{}: HTTP status {}: {}", what, result->status,
                                                    shortened(answer.body)));
  }
  answer.type = lower(result->get_header_value("Content-Type"));
  return answer;
}

json Connection::checked(const std::string& body, const std::string& what) {
  const json answer = json::parse(body, nullptr, false);
  if (!answer.is_object()) {
    throw Error(ErrorCode::bad_data,
                fmt::format("{} of {} answers what is no JSON object", what, address_.text()));
  }
  const auto whole = [&](const char* key) {
    const auto found = answer.find(key);
    return found != answer.end() && found->is_number_integer() ? found->get<long long>() : 0;
  };
  const auto message = answer.find("ErrorMessage");
  const std::string said =
      message != answer.end() && message->is_string() ? message->get<std::string>() : "";
  require_no_error(whole("ErrorNumber"), said, fmt::format("{} of {}", what, address_.text()));
  const long long transaction = whole("ClientTransactionID");
  // Servers that do not keep the number say 0.
  if (transaction != 0 && transaction != transaction_) {
    throw Error(ErrorCode::bad_data,
                fmt::format("{} of {} is the answer to another question ({}, not {})", what,
                            address_.text(), transaction, transaction_));
  }
  const auto value = answer.find("Value");
  return value == answer.end() ? json() : *value;
}

json Connection::value(const std::string& path) {
  httplib::Request request;
  request.method = "GET";
  request.path = path + "?" + numbers();
  return checked(ask(request, kMostBytes).body, path);
}

std::vector<DeviceEntry> Connection::devices() {
  const json list = value("/management/v1/configureddevices");
  std::vector<DeviceEntry> devices;
  if (!list.is_array()) return devices;
  for (const json& item : list) {
    if (!item.is_object()) continue;
    const auto kind = item.find("DeviceType"), number = item.find("DeviceNumber"),
               name = item.find("DeviceName");
    if (kind == item.end() || !kind->is_string() || number == item.end() ||
        !number->is_number_integer()) {
      continue;
    }
    devices.push_back({lower(kind->get<std::string>()), number->get<int>(),
                       name != item.end() && name->is_string() ? name->get<std::string>() : ""});
  }
  return devices;
}

double Connection::number(const std::string& device, const std::string& property) {
  const json found = value("/api/v1/" + device + "/" + lower(property));
  if (found.is_number()) return found.get<double>();
  throw Error(ErrorCode::bad_data,
              fmt::format("{} of {} at {} is no number", property, device, address_.text()));
}

bool Connection::flag(const std::string& device, const std::string& property) {
  const json found = value("/api/v1/" + device + "/" + lower(property));
  if (found.is_boolean()) return found.get<bool>();
  throw Error(ErrorCode::bad_data, fmt::format("{} of {} at {} is neither true nor false", property,
                                               device, address_.text()));
}

std::string Connection::text(const std::string& device, const std::string& property) {
  const json found = value("/api/v1/" + device + "/" + lower(property));
  return found.is_string() ? found.get<std::string>() : "";
}

void Connection::put(const std::string& device, const std::string& method,
                     const std::string& parameters) {
  httplib::Request request;
  request.method = "PUT";
  request.path = "/api/v1/" + device + "/" + lower(method);
  request.body = parameters + (parameters.empty() ? "" : "&") + numbers();
  request.set_header("Content-Type", "application/x-www-form-urlencoded");
  checked(ask(request, kMostBytes).body, request.path);
}

Connection::Picture Connection::picture(const std::string& device, std::size_t most_bytes) {
  httplib::Request request;
  request.method = "GET";
  request.path = "/api/v1/" + device + "/imagearray?" + numbers();
  request.set_header("Accept", std::string(kImageBytes) + ", application/json");
  Answer answer = ask(request, most_bytes);
  return {std::move(answer.body), answer.type.find(kImageBytes) != std::string::npos};
}

}  // namespace fathom::alpaca
