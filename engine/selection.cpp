// SPDX-License-Identifier: Apache-2.0
#include "engine/selection.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <optional>
#include <vector>

#include "engine/error.hpp"

namespace fathom {
namespace {

struct Candidate {
  const Backend* backend;
  std::size_t index;
  DeviceInfo info;

  std::string label() const { return fmt::format("{}:{} ({})", backend->name(), index, info.name); }
};

std::vector<Candidate> devices_of(const Backend& backend) {
  std::vector<Candidate> candidates;
  const auto infos = backend.devices();
  for (std::size_t i = 0; i < infos.size(); ++i) candidates.push_back({&backend, i, infos[i]});
  return candidates;
}

/// The first candidate that opens and takes the metric; appends to `others` why each other one was
/// not taken.
std::optional<Selection> first_that_accepts(const std::vector<Candidate>& candidates,
                                            const MetricSpec& spec, const DeviceOptions& options,
                                            std::vector<std::string>& others) {
  std::optional<Selection> chosen;
  for (const Candidate& candidate : candidates) {
    if (chosen) {  // a backend's other devices are no other choice
      if (chosen->backend != candidate.backend->name()) {
        others.push_back(candidate.label() + ": comes later");
      }
      continue;
    }
    try {
      auto device = candidate.backend->open(candidate.index, options);
      const std::string reason = device->unsupported(spec);
      if (reason.empty()) {
        chosen = Selection{candidate.backend->name(), std::move(device), candidate.label()};
      } else {
        others.push_back(candidate.label() + ": " + reason);
      }
    } catch (const Error& error) {
      if (error.code() == ErrorCode::bad_argument)
        throw;  // the options; no other device likes them
      others.push_back(candidate.label() + ": " + error.what());
    }
  }
  return chosen;
}

[[noreturn]] void refuse_all(const MetricSpec& spec, const std::vector<std::string>& refusals) {
  throw Error(ErrorCode::unsupported,
              fmt::format("no device computes {}: {}", spec.text(), fmt::join(refusals, "; ")));
}

Selection finish(Selection selection, std::string_view why,
                 const std::vector<std::string>& refusals) {
  selection.reason = fmt::format("{}, {}", selection.reason, why);
  if (!refusals.empty()) selection.reason += fmt::format("; not {}", fmt::join(refusals, "; not "));
  return selection;
}

Selection select_automatically(std::span<const Backend* const> backends, const MetricSpec& spec,
                               Workload workload, const DeviceOptions& options) {
  const bool batches = workload == Workload::batches;
  const DeviceKind wanted = batches ? DeviceKind::gpu : DeviceKind::cpu;
  std::vector<std::string> others;
  std::vector<Candidate> candidates;
  for (const Backend* backend : backends) {
    for (Candidate& candidate : devices_of(*backend)) {
      if (candidate.info.kind == DeviceKind::software) {
        others.push_back(candidate.label() + ": a software rasteriser, only on request");
      } else {
        candidates.push_back(std::move(candidate));
      }
    }
  }
  std::stable_partition(candidates.begin(), candidates.end(),
                        [&](const Candidate& candidate) { return candidate.info.kind == wanted; });
  if (auto chosen = first_that_accepts(candidates, spec, options, others)) {
    const bool as_wanted = chosen->device->info().kind == wanted;
    return finish(std::move(*chosen),
                  fmt::format("{} {} for {}", as_wanted ? "a" : "there being no",
                              batches ? "GPU" : "CPU", batches ? "batches" : "single windows"),
                  others);
  }
  refuse_all(spec, others);
}

std::vector<Candidate> matching(std::vector<Candidate> devices, std::string_view which) {
  std::size_t index = 0;
  const char* const end = which.data() + which.size();
  const auto [next, problem] = std::from_chars(which.data(), end, index);
  const bool by_index = problem == std::errc() && next == end;
  std::erase_if(devices, [&](const Candidate& candidate) {
    return by_index ? candidate.index != index
                    : candidate.info.name.find(which) == std::string::npos;
  });
  return devices;
}

Selection select_by_name(std::span<const Backend* const> backends, std::string_view choice,
                         const MetricSpec& spec, const DeviceOptions& options) {
  const std::size_t colon = choice.find(':');
  const std::string_view name = choice.substr(0, colon);
  std::vector<std::string> names;
  for (const Backend* backend : backends) {
    names.emplace_back(backend->name());
    if (name != backend->name()) continue;
    auto devices = devices_of(*backend);
    std::vector<std::string> labels;
    for (const Candidate& device : devices) labels.push_back(device.label());
    if (colon != std::string_view::npos) {
      if (colon + 1 == choice.size()) {
        throw Error(ErrorCode::bad_argument,
                    fmt::format("backend \"{}\" names no device; write {} or {}:INDEX, as fathom "
                                "devices lists them",
                                choice, name, name));
      }
      devices = matching(std::move(devices), choice.substr(colon + 1));
    }
    if (devices.empty()) {
      throw Error(
          ErrorCode::unavailable,
          labels.empty()
              ? fmt::format("backend {} has no device on this machine; see fathom devices", name)
              : fmt::format("no device \"{}\"; there are {}", choice, fmt::join(labels, ", ")));
    }
    std::vector<std::string> refusals;
    if (auto chosen = first_that_accepts(devices, spec, options, refusals)) {
      return finish(std::move(*chosen), "as asked", refusals);
    }
    refuse_all(spec, refusals);
  }
  throw Error(ErrorCode::unavailable,
              fmt::format("no backend \"{}\"; there are auto, {}", name, fmt::join(names, ", ")));
}

}  // namespace

Selection select_device(std::span<const Backend* const> backends, std::string_view choice,
                        const MetricSpec& spec, Workload workload, const DeviceOptions& options) {
  if (choice.empty()) {
    const char* const wished = std::getenv("FATHOM_BACKEND");
    choice = wished != nullptr ? wished : "auto";
  }
  if (choice.empty() || choice == "auto")
    return select_automatically(backends, spec, workload, options);
  if (choice.starts_with("auto:")) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("backend \"{}\": auto takes no index, it chooses the device itself; "
                            "write auto, or NAME:INDEX as fathom devices lists them",
                            choice));
  }
  return select_by_name(backends, choice, spec, options);
}

}  // namespace fathom
