// SPDX-License-Identifier: Apache-2.0
// Scores every window of a picture and prints the sharpest: the C++ library in one page.
//
//   score_window PICTURE [METRIC]         e.g. score_window photo.png walsh-sequency:64

#include <fathom/backends/backends.hpp>
#include <fathom/engine/error.hpp>
#include <fathom/engine/selection.hpp>
#include <fathom/pictures/picture.hpp>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

namespace {

void print_sharpest(const std::string& picture, const std::string& metric) {
  const auto spec = fathom::MetricSpec::parse(metric);
  const auto frame = fathom::read_picture(picture);
  const auto windows =
      fathom::window_grid(frame.width_px(), frame.height_px(), {0, 0, spec.n}, spec.n / 2);

  // The backend first: opening a device and planning cost time, scoring with a plan does not.
  const auto selection =
      fathom::select_device(fathom::all_backends(), "auto", spec, windows.size());
  const auto plan = selection.device->plan(spec, windows.size());

  std::vector<double> scores(windows.size());
  plan->score(frame, windows, scores);

  const auto best = std::max_element(scores.begin(), scores.end()) - scores.begin();
  std::printf("%s of %zu windows: sharpest at %s, focus quality %.6g\n", spec.text().c_str(),
              windows.size(), fathom::to_string(windows[best]).c_str(), scores[best]);
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
  return 0;
}
