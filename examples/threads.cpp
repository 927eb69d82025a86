// SPDX-License-Identifier: Apache-2.0
// One device, and a plan for each thread.
#include <fathom/backends/backends.hpp>
#include <fathom/engine/selection.hpp>

#include <array>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <thread>
#include <vector>

int main() {
  constexpr int kSide = 64;
  std::vector<std::uint8_t> pixels(kSide * kSide, 0);
  pixels[kSide * kSide / 2] = 255;
  const auto frame = fathom::Frame::view(pixels.data(), kSide, kSide, fathom::Depth::bits8, kSide);

  const auto spec = fathom::MetricSpec::parse("walsh-paley:64");
  const auto selection = fathom::select_device(fathom::all_backends(), "cpu", spec, 1,
                                               {.threads = 1});  // The threads are our own.

  std::array<double, 4> scores{};
  std::vector<std::thread> workers;
  for (double& score : scores) {
    std::shared_ptr<fathom::Plan> plan = selection.device->plan(spec, 1);
    workers.emplace_back(
        [&score, &frame, plan] { score = plan->score(frame, {.x = 0, .y = 0, .n = kSide}); });
  }
  for (std::thread& worker : workers) worker.join();

  const bool are_equal = scores[0] == scores[1] && scores[1] == scores[2] && scores[2] == scores[3];
  std::printf("%s\n", are_equal ? "all alike, to the last bit" : "they differ");
}
