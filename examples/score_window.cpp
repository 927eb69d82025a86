// SPDX-License-Identifier: Apache-2.0
// Scores a grid of windows of a picture file and prints the sharpest.
//
//   score_window PICTURE [METRIC]         e.g. score_window photo.png walsh-sequency:64
#include <fathom/backends/backends.hpp>
#include <fathom/engine/error.hpp>
#include <fathom/engine/scorer.hpp>
#include <fathom/pictures/picture.hpp>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

namespace {

void print_sharpest(const std::string& picture, const std::string& metric) {
  const auto spec = fathom::MetricSpec::parse(metric);
  const auto frame = fathom::read_picture(picture);

  // Every window that lies whole strides from the first one; half a window is the stride here.
  const fathom::WindowGrid grid(frame.width_px(), frame.height_px(), {0, 0, spec.n}, spec.n / 2);
  fathom::Scorer scorer(fathom::select_device(fathom::all_backends(), "auto", spec, grid.size()),
                        spec, grid);

  std::vector<double> scores(grid.size());
  scorer.score(frame, scores);

  const auto best = std::max_element(scores.begin(), scores.end()) - scores.begin();
  std::printf("%s of %zu windows: sharpest at %s, focus quality %.6g\n", spec.text().c_str(),
              grid.size(), fathom::to_string(grid[best]).c_str(), scores[best]);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3) {
    std::fprintf(stderr, "usage: score_window PICTURE [METRIC]\n");
    return 2;
  }
  try {
    print_sharpest(argv[1], argc == 3 ? argv[2] : "fft:64");
  } catch (const fathom::Error& error) {
    std::fprintf(stderr, "score_window: %s\n", error.what());
    return 1;
  }
}
