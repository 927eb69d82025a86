// SPDX-License-Identifier: Apache-2.0
// fathom rigs: what is plugged in, whether a rig works and how it should be set, and where its lens
// stands.
#include "engine/error.hpp"
#include "hal/rig_driver.hpp"
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/rigs_check.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {
namespace {

const char* parts_of(const FoundHardware& found) {
  if (found.has_camera) return found.has_lens ? "camera, lens" : "camera";
  return found.has_lens ? "lens" : "-";
}

void print_found(const char* driver, const FoundHardware& found, bool json) {
  if (json) {
    JsonLine line;
    line.add("driver", driver)
        .add("rig", found.text)
        .add("camera", found.has_camera ? 1 : 0)
        .add("lens", found.has_lens ? 1 : 0)
        .add("description", found.description)
        .add("problem", found.problem);
    return print_line(line.text());
  }
  print_line(fmt::format("{:<28} {:<13} {}", found.text, parts_of(found), found.description));
  if (!found.problem.empty()) print_line(fmt::format("{:<28} {}", "", found.problem));
}

/// A driver that could not look, or that this build was made without: where, in words, and why.
void print_shut(const char* driver, const char* what, const std::string& why, bool json) {
  if (json) return print_found(driver, {.text = {}, .description = {}, .problem = why}, json);
  print_line(fmt::format("{}: {} ({})", what, driver, why));
}

void list(bool json) {
  std::string nothing;
  for (const RigDriver* driver : all_rig_drivers()) {
    const auto found = driver->find();
    for (const FoundHardware& one : found) print_found(driver->name(), one, json);
    const std::string obstacle = found.empty() ? driver->obstacle() : "";
    if (!obstacle.empty()) print_shut(driver->name(), "not to be looked at", obstacle, json);
    // What is made of files and formulas, or is far away, is not plugged in.
    if (found.empty() && obstacle.empty() && driver->has_lens_traits())
      nothing += fmt::format("{}{}", nothing.empty() ? "" : ", ", driver->name());
  }
  if (!nothing.empty() && !json) print_line("nothing found for: " + nothing);
  for (const AbsentRigDriver& absent : absent_rig_drivers())
    print_shut(absent.name, "not in this build", absent.reason, json);
  if (json) return;
  print_line("without hardware: sim (the thesis rig, simulated), replay:PATH (recorded pictures)");
  print_line("elsewhere: http://HOST:8470?token=TOKEN (the rig of a fathom serve)");
}

void add_list(Verb& rigs) {
  Verb list_verb = rigs.add_verb("list", "List the cameras and lenses plugged in");
  list_verb.set_footer("Examples:\n  fathom rigs list\n  fathom rigs list --json");
  auto json = std::make_shared<bool>(false);
  list_verb.add_flag("--json", *json, "One JSON object a line on standard output");
  list_verb.on_run([json] {
    list(*json);
    return kDone;
  });
}

struct HomeArguments {
  std::string rig;
  std::optional<double> at;
};

int home(const HomeArguments& arguments) {
  const Hardware rig =
      open_hardware(arguments.rig, {.camera = false, .stop_requests = stop_requests});
  const LensInfo info = rig.lens->info();
  if (arguments.at) {
    rig.lens->declare_at(*arguments.at);
    print_line(
        fmt::format("the lens is said to stand at {:g} {}", rig.lens->position(), info.unit));
    return kDone;
  }
  const Arrival arrival = rig.lens->home();
  print_line(fmt::format("home: the lens stands at {:g} {}", arrival.position, info.unit));
  if (!arrival.note.empty()) note(arrival.note);
  return kDone;
}

void add_home(Verb& rigs) {
  Verb home_verb = rigs.add_verb(
      "home", "Send the lens to its stop or switch, so that its positions are true again");
  home_verb.set_footer(
      "A motor that was cut off in mid-move does not know where it stands.\n\nExamples:\n"
      "  fathom rigs home my-rig.toml\n  fathom rigs home my-rig.toml --at 0");
  auto arguments = std::make_shared<HomeArguments>();
  home_verb.add_option("RIG", arguments->rig, "The rig, as --rig takes it").required();
  home_verb.add_option("--at", arguments->at,
                       "Move nothing: the lens was put at this position by hand");
  home_verb.on_run([arguments] { return home(*arguments); });
}

void add_check(Verb& rigs) {
  Verb check_verb = rigs.add_verb(
      "check", "Try a rig: frames, focus, settling, backlash; suggest its file's values");
  check_verb.set_footer(
      "Point the camera at something with texture that does not move; the check takes a minute "
      "or two.\n\nExamples:\n  fathom rigs check my-rig.toml\n  fathom rigs check sim\n\n"
      "Exit status: 0 checked, 1 error, 2 wrong usage, 3 no focus found, so not all could be "
      "measured.");
  auto arguments = std::make_shared<CheckArguments>();
  check_verb.add_option("RIG", arguments->rig, "The rig, as --rig takes it").required();
  arguments->metric.add_to(check_verb);
  check_verb.add_flag("--json", arguments->json, "One JSON object on standard output");
  check_verb.on_run([arguments] { return check_rig(*arguments); });
}

}  // namespace

void add_rigs(Verb& program) {
  Verb verb = program.add_verb("rigs", "List what is plugged in; check a rig; home a lens");
  verb.require_verb();
  verb.set_footer(
      "Examples:\n  fathom rigs list\n  fathom rigs check my-rig.toml\n"
      "  fathom rigs home my-rig.toml\n\nfathom help rigs tells what a rig is and how to name it.");
  add_list(verb);
  add_check(verb);
  add_home(verb);
}

}  // namespace fathom::cli
