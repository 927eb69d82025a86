// SPDX-License-Identifier: Apache-2.0
#include "engine/device_list.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <sstream>

#include "engine/cache.hpp"
#include "engine/findings.hpp"
#include "engine/process.hpp"

namespace fathom {
namespace {

constexpr DeviceKind kKinds[] = {DeviceKind::cpu, DeviceKind::gpu, DeviceKind::software};

std::string file_of(const Backend& backend) { return fmt::format("devices-{}", backend.name()); }

std::optional<DeviceKind> kind_of(const std::string& text) {
  for (const DeviceKind kind : kKinds) {
    if (text == to_string(kind)) return kind;
  }
  return std::nullopt;
}

/// Three lines a device. In the file, a line with the time stands before them.
std::string text_of(const std::vector<DeviceInfo>& infos) {
  std::string text;
  for (const DeviceInfo& info : infos) {
    text += fmt::format("{}\n{}\n{}\n", to_string(info.kind), info.name, info.details);
  }
  return text;
}

bool is_one_line(const DeviceInfo& info) {
  return (info.name + info.details).find('\n') == std::string::npos;
}

/// Nothing where the file's text is not one of list_devices(), or is old.
std::optional<std::vector<DeviceInfo>> infos_in(const std::string& text, double now_s) {
  std::istringstream lines(text);
  double at_s = 0;
  if (!(lines >> at_s) || now_s < at_s || now_s > at_s + kOld_s) return std::nullopt;
  std::string kind_name, name, details;
  std::getline(lines, kind_name);
  std::vector<DeviceInfo> infos;
  while (std::getline(lines, kind_name) && std::getline(lines, name) &&
         std::getline(lines, details)) {
    const auto kind = kind_of(kind_name);
    if (!kind) return std::nullopt;
    infos.push_back({name, *kind, details});
  }
  return infos;
}

}  // namespace

std::vector<DeviceInfo> list_devices(const Backend& backend, const Clock& clock) {
  // What drivers say then is no list to keep; open() tells why.
  if (backend.is_for_gpus() && (forks() > 0 || !can_start_drivers())) return backend.devices();
  auto infos = backend.devices();
  bool is_plain = true;
  for (const DeviceInfo& info : infos) is_plain = is_plain && is_one_line(info);
  const std::string drivers = backend.drivers();
  if (!is_plain || drivers.empty()) return infos;
  const double now_s = clock.calendar_s();
  const auto kept = read_cached(file_of(backend), drivers);
  const auto known = kept ? infos_in(*kept, now_s) : std::nullopt;
  if (!known || text_of(*known) != text_of(infos)) {
    write_cached(file_of(backend), drivers,
                 fmt::format("{:.0f}\n{}", std::floor(now_s), text_of(infos)));
  }
  return infos;
}

std::vector<DeviceInfo> known_devices(const Backend& backend, const OnWork& on_work,
                                      const Clock& clock) {
  const std::string drivers = backend.drivers();
  if (!drivers.empty()) {
    const auto kept = read_cached(file_of(backend), drivers);
    if (auto infos = kept ? infos_in(*kept, clock.calendar_s()) : std::nullopt) return *infos;
  }
  if (on_work && backend.is_for_gpus()) on_work(Work::listing, backend.name());
  return list_devices(backend, clock);
}

void forget_devices(const Backend& backend) { write_cached(file_of(backend), {}, {}); }

}  // namespace fathom
