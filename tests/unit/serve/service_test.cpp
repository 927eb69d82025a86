// SPDX-License-Identifier: Apache-2.0
// The service as a whole begins and ends. What it answers is tested from outside, in
// tests/end_to_end/serve_test.py.
#include "serve/service.hpp"

#include <gtest/gtest.h>

#include "engine/clock.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fathom::serve {
namespace {

TEST(Service, EndsAlsoWhereItIsStoppedBeforeItRuns) {
  const test::TemporaryFolder folder;
  Publisher publisher;
  RigOptions rig;
  rig.rig = "sim";
  rig.backend = "cpu";
  Operator the_operator({.rig = rig, .folder = folder.path(), .version = "0"}, publisher);
  Api api(the_operator, publisher, folder.path(), false, machine_clock());
  Service service({.port = 0, .token = "0123456789abcdef"}, api);
  service.stop();
  service.run();
}

}  // namespace
}  // namespace fathom::serve
