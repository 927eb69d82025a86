// SPDX-License-Identifier: Apache-2.0
// A folder of pictures, and the rig that plays it.
#pragma once

#include <gtest/gtest.h>

#include "engine/file.hpp"
#include "hal/rig_driver.hpp"
#include "pictures/picture.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fathom::test {

using namespace std::chrono_literals;

/// A frame whose every pixel is `grey`, so that a test sees which one it was given.
inline Frame plain(std::uint8_t grey, int width = 8, int height = 8) {
  const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  return Frame(width, height, std::vector<std::uint8_t>(count, grey));
}

/// The findings of one kind.
template <class Kind>
std::vector<Kind> findings_of(const Hardware& rig) {
  std::vector<Kind> found;
  for (const Finding& finding : rig.findings) {
    if (const auto* one = std::get_if<Kind>(&finding)) found.push_back(*one);
  }
  return found;
}

class Replay : public testing::Test {
 protected:
  void picture(const std::string& name, std::uint8_t grey) {
    write_picture(folder_ / name, plain(grey));
  }
  void manifest(const std::string& text) { write_file(folder_ / "manifest.csv", text); }
  Hardware open() { return open_hardware("replay:" + folder_.path().string()); }
  void expect_refused(ErrorCode code, std::initializer_list<const char*> texts) {
    expect_error(
        code, [this] { open(); }, texts);
  }
  static std::uint32_t grey(Hardware& rig) { return rig.camera->grab(1s).value().at(0, 0); }

  TemporaryFolder folder_;
};

}  // namespace fathom::test
