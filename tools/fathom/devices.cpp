// SPDX-License-Identifier: Apache-2.0
// fathom devices: what this machine computes with.
#include "backends/backends.hpp"
#include "engine/selection.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {
namespace {

void print_device(const Backend& backend, std::size_t index, const DeviceInfo& info, bool json) {
  if (json) {
    print_line(JsonLine()
                   .add("backend", backend.name())
                   .add("index", index)
                   .add("name", info.name)
                   .add("kind", to_string(info.kind))
                   .add("details", info.details)
                   .text());
  } else {
    print_line(fmt::format("{:<16} {:<9} {}: {}", fmt::format("{}:{}", backend.name(), index),
                           to_string(info.kind), info.name, info.details));
  }
}

void run(bool json) {
  for (const Backend* backend : all_backends()) {
    const auto infos = backend->devices();
    for (std::size_t i = 0; i < infos.size(); ++i) print_device(*backend, i, infos[i], json);
    if (infos.empty() && !json) print_line(fmt::format("{:<16} no device", backend->name()));
  }
  if (json) return;
  const MetricSpec usual = MetricSpec::standard(Transform::fft, 64);
  print_line(fmt::format(
      "auto takes {} for {}",
      select_device(all_backends(), "auto", usual, Workload::single_windows).reason, usual.text()));
}

}  // namespace

void add_devices(CLI::App& app, int& status) {
  auto* const verb = app.add_subcommand("devices", "List the backends and devices of this machine");
  verb->footer("Example:\n  fathom devices --json");
  auto json = std::make_shared<bool>(false);
  verb->add_flag("--json", *json, "One JSON object a line on standard output");
  verb->callback([json, &status] {
    run(*json);
    status = kDone;
  });
}

}  // namespace fathom::cli
