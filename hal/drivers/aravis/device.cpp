// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/aravis/device.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <system_error>
#include <thread>

#include "engine/error.hpp"

namespace fathom::aravis {
namespace {

using Flag = std::shared_ptr<std::atomic<bool>>;

void on_lost(ArvDevice*, gpointer flag) { (*static_cast<Flag*>(flag))->store(true); }

/// When Aravis' device goes, which may be after ours.
void drop_flag(gpointer flag, GClosure*) { delete static_cast<Flag*>(flag); }

std::string taken(GError* error) {
  std::string message = error->message;
  api().g_error_free(error);
  return message;
}

std::string text_or(const char* text, const char* fallback) {
  return text == nullptr || *text == 0 ? fallback : text;
}

/// Without a name there must be one.
std::string only_camera() {
  api().arv_update_device_list();
  std::vector<std::string> ids;
  for (unsigned i = 0; i < api().arv_get_n_devices(); ++i)
    ids.push_back(text_or(api().arv_get_device_id(i), "?"));
  if (ids.size() == 1) return ids.front();
  if (ids.empty()) {
    throw Error(ErrorCode::unavailable,
                "no GigE Vision or USB3 Vision camera answers; is it powered, and in this "
                "computer's network? `fathom rigs list` shows what is there");
  }
  throw Error(ErrorCode::bad_argument, fmt::format("there is more than one camera: {}; say which "
                                                   "with aravis:ID",
                                                   fmt::join(ids, ", ")));
}

}  // namespace

std::shared_ptr<Device> Device::open(const std::string& name) {
  const std::string id = name.empty() ? only_camera() : name;
  GError* error = nullptr;
  ArvCamera* const camera = api().arv_camera_new(id.c_str(), &error);
  if (error == nullptr && camera != nullptr) return std::shared_ptr<Device>(new Device(camera, id));
  const std::string why = error == nullptr ? "" : ": " + taken(error);
  throw Error(ErrorCode::unavailable,
              fmt::format("cannot open the camera \"{}\"{}; is it there, does this user have "
                          "permission (USB), and does no other program have it? `fathom rigs "
                          "list` shows the cameras",
                          id, why));
}

Device::Device(ArvCamera* camera, std::string name)
    : camera_(camera),
      name_(std::move(name)),
      model_(fmt::format("{} {}", text_or(api().arv_camera_get_vendor_name(camera, nullptr), "?"),
                         text_or(api().arv_camera_get_model_name(camera, nullptr), "?"))),
      lost_(std::make_shared<std::atomic<bool>>(false)) {
  api().g_signal_connect_data(api().arv_camera_get_device(camera_), "control-lost",
                              reinterpret_cast<GCallback>(on_lost), new Flag(lost_), drop_flag,
                              GConnectFlags{});
}

Device::~Device() { let_go(camera_); }

void Device::let_go(void* object) const noexcept {
  if (is_lost()) {
    try {
      std::thread([object] { api().g_object_unref(object); }).detach();
      return;
    } catch (const std::system_error&) {  // no thread to be had: then it is waited for
    }
  }
  api().g_object_unref(object);
}

void Device::fail_lost() const {
  throw Error(
      ErrorCode::device_lost,
      fmt::format("{} does not answer any more; was it unplugged or reset? Open it again", name_));
}

void Device::fail(GError* error, const std::string& doing) const {
  const bool is_of_device = error->domain == api().arv_device_error_quark();
  const int code = is_of_device ? error->code : -1;
  const std::string why = taken(error);
  if (code == ARV_DEVICE_ERROR_TIMEOUT || code == ARV_DEVICE_ERROR_NOT_CONNECTED ||
      code == ARV_DEVICE_ERROR_TRANSFER_ERROR) {
    lost_->store(true);
    throw Error(ErrorCode::device_lost, fmt::format("{}: cannot {}: {}", name_, doing, why));
  }
  if (code == ARV_DEVICE_ERROR_NOT_CONTROLLER ||
      code == ARV_DEVICE_ERROR_PROTOCOL_ERROR_ACCESS_DENIED) {
    throw Error(ErrorCode::unavailable,
                fmt::format("{}: cannot {}: another program controls it; end that", name_, doing));
  }
  throw Error(ErrorCode::unsupported, fmt::format("{}: cannot {}: {}", name_, doing, why));
}

bool Device::has(const std::string& feature) const {
  return ask("look for " + feature, [&](GError** error) {
           return api().arv_camera_is_feature_available(camera_, feature.c_str(), error);
         }) != 0;
}

bool Device::has_choice(const std::string& feature, const std::string& choice) const {
  return has(feature) && ask("look for " + choice, [&](GError** error) {
                           return api().arv_camera_is_enumeration_entry_available(
                               camera_, feature.c_str(), choice.c_str(), error);
                         }) != 0;
}

std::string Device::text(const std::string& feature) const {
  return text_or(ask("read " + feature,
                     [&](GError** error) {
                       return api().arv_camera_get_string(camera_, feature.c_str(), error);
                     }),
                 "");
}

void Device::set_text(const std::string& feature, const std::string& value) const {
  ask(fmt::format("set {} to {}", feature, value), [&](GError** error) {
    api().arv_camera_set_string(camera_, feature.c_str(), value.c_str(), error);
  });
}

std::int64_t Device::integer(const std::string& feature) const {
  return ask("read " + feature, [&](GError** error) {
    return api().arv_camera_get_integer(camera_, feature.c_str(), error);
  });
}

void Device::set_integer(const std::string& feature, std::int64_t value) const {
  ask(fmt::format("set {} to {}", feature, value), [&](GError** error) {
    api().arv_camera_set_integer(camera_, feature.c_str(), value, error);
  });
}

Range Device::integer_range(const std::string& feature) const {
  gint64 lowest = 0, highest = 0;
  ask("read the range of " + feature, [&](GError** error) {
    api().arv_camera_get_integer_bounds(camera_, feature.c_str(), &lowest, &highest, error);
  });
  const gint64 step = ask("read the step of " + feature, [&](GError** error) {
    return api().arv_camera_get_integer_increment(camera_, feature.c_str(), error);
  });
  return {static_cast<double>(lowest), static_cast<double>(highest),
          static_cast<double>(step > 0 ? step : 1)};
}

double Device::number(const std::string& feature) const {
  return ask("read " + feature, [&](GError** error) {
    return api().arv_camera_get_float(camera_, feature.c_str(), error);
  });
}

void Device::set_number(const std::string& feature, double value) const {
  ask(fmt::format("set {} to {}", feature, value),
      [&](GError** error) { api().arv_camera_set_float(camera_, feature.c_str(), value, error); });
}

Range Device::number_range(const std::string& feature) const {
  Range range;
  ask("read the range of " + feature, [&](GError** error) {
    api().arv_camera_get_float_bounds(camera_, feature.c_str(), &range.lowest, &range.highest,
                                      error);
  });
  GError* without = nullptr;
  range.step = api().arv_camera_get_float_increment(camera_, feature.c_str(), &without);
  // Of a feature without a step Aravis tells an error, or the least number that there is.
  if (without != nullptr) api().g_error_free(without);
  if (without != nullptr || !(range.step > 1e-12)) range.step = 0;
  return range;
}

void Device::execute(const std::string& command) const {
  ask(fmt::format("give the command {}", command),
      [&](GError** error) { api().arv_camera_execute_command(camera_, command.c_str(), error); });
}

void FeatureRestorer::set_text(const std::string& feature, const std::string& value) {
  if (!device_->has_choice(feature, value)) return;
  const std::string found = device_->text(feature);
  if (found == value) return;
  at_end([device = device_, feature, found] { device->set_text(feature, found); });
  device_->set_text(feature, value);
  if (device_->text(feature) == value) return;
  throw Error(ErrorCode::io,
              fmt::format("{}: {} stays {}", device_->name(), feature, device_->text(feature)));
}

}  // namespace fathom::aravis
