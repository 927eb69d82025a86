// SPDX-License-Identifier: Apache-2.0
// A service that runs for a day keeps no more than one that runs for a minute.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <malloc.h>

#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "pictures/picture.hpp"
#include "serve/operator.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fathom::serve {
namespace {

using namespace std::chrono_literals;

/// A day at 30 a second has 2 592 000 frames: FATHOM_SERVED_FRAMES=2592000.
long frames_to_take() {
  constexpr long kUsual = 20'000;
  const char* const wished = std::getenv("FATHOM_SERVED_FRAMES");
  return wished != nullptr ? std::atol(wished) : kUsual;
}

void go_to(Operator& the_operator, double position) {
  const int id = the_operator.begin_move(position);
  while (!the_operator.moved(id, 1s).is_done) {
  }
}

/// Bytes that are in use. Nothing under a sanitizer, whose allocator is another.
std::size_t bytes_in_use() { return mallinfo2().uordblks + mallinfo2().hblkhd; }

/// Small pictures cost little, and go the way of large ones.
void record(const std::filesystem::path& folder) {
  constexpr int kPictures = 10, kSide = 24;
  for (int i = 0; i < kPictures; ++i) {
    std::vector<std::uint8_t> pixels;
    for (int k = 0; k < kSide * kSide; ++k) pixels.push_back(static_cast<std::uint8_t>(i * k));
    write_picture(folder / fmt::format("{}.png", i), Frame(kSide, kSide, std::move(pixels)));
  }
}

TEST(ServedForADay, MemoryIsFlat) {
  const test::TemporaryFolder folder, pictures;
  record(pictures.path());
  Publisher publisher;
  RigOptions rig;
  rig.rig = "replay:" + pictures.path().string();
  rig.window = Window{0, 0, 16};
  rig.backend = "cpu";
  Operator the_operator({.rig = rig, .folder = folder.path(), .version = "0"}, publisher);
  // Two who watch and never read: all that is kept for them has an end.
  publisher.events.add_reader(1);
  publisher.pictures.add_watcher(1);
  constexpr long kBetweenMoves = 1000;
  const auto take = [&](long frames) {
    for (long i = 0; i < frames; ++i) {
      ASSERT_TRUE(the_operator.take(1s));
      if (i % kBetweenMoves == 0) go_to(the_operator, static_cast<double>(i / kBetweenMoves % 10));
    }
  };
  constexpr long kWarmUp = 5'000;  // until every ring is full
  take(kWarmUp);
  const std::size_t before = bytes_in_use();
  if (before == 0) GTEST_SKIP() << "this allocator does not say what is in use";
  take(frames_to_take());
  constexpr std::size_t kRoom = 256 << 10;
  EXPECT_LE(bytes_in_use(), before + kRoom) << before << " bytes at first";
  publisher.events.close();
  publisher.pictures.close();
}

}  // namespace
}  // namespace fathom::serve
