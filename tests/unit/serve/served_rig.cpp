// SPDX-License-Identifier: Apache-2.0
#include "served_rig.hpp"

#include <fmt/format.h>

#include <thread>

#include "engine/clock.hpp"
#include "serve/service.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fathom::test {
namespace {

constexpr const char* kToken = "0123456789abcdef";

RigOptions options_of(const std::string& rig) {
  RigOptions options;
  options.rig = rig;
  options.backend = "cpu";
  options.window = Window{0, 0, 16};  // in pictures of any size
  return options;
}

}  // namespace

struct ServedRig::Parts {
  Parts(const std::string& rig, bool is_read_only)
      : the_operator({.rig = options_of(rig),
                      .folder = folder.path(),
                      .version = "0",
                      .is_read_only = is_read_only},
                     publisher),
        api(the_operator, publisher, folder.path(), is_read_only, machine_clock()),
        service({.port = 0, .token = kToken}, api),
        serving([this] { service.run(); }) {}

  TemporaryFolder folder;
  serve::Publisher publisher;
  serve::Operator the_operator;
  serve::Api api;
  serve::Service service;
  std::thread serving;
};

ServedRig::ServedRig(const std::string& rig, bool is_read_only)
    : parts_(std::make_unique<Parts>(rig, is_read_only)) {}

ServedRig::~ServedRig() {
  parts_->the_operator.finish();
  parts_->publisher.events.close();
  parts_->publisher.pictures.close();
  parts_->service.stop();
  parts_->serving.join();
}

std::string ServedRig::bare_text() const {
  return fmt::format("http://127.0.0.1:{}", parts_->service.port());
}

std::string ServedRig::text() const { return bare_text() + "?token=" + kToken; }

}  // namespace fathom::test
