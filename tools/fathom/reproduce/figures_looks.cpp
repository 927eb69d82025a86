// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "tools/fathom/image_panel.hpp"
#include "tools/fathom/reproduce/figures.hpp"

namespace fathom::reproduce {
namespace {

constexpr int kWidth = 480, kHeight = 420, kFont = 16;  // of one of three side by side

const char* name_of(const Look& look) { return look.sharp ? "sharp" : "blurred"; }

std::string sharpness(bool sharp) {
  return sharp ? "in focus" : fmt::format("{:g} steps off", kBlurSteps);
}

/// A line for each picture: what each band adds to the score.
cli::Curve band_curve(const SpectrumLook& look, bool sharp, double unit) {
  cli::Curve curve{sharp ? cli::CurveStyle::line : cli::CurveStyle::dashed,
                   sharpness(sharp),
                   {},
                   kColours[look.transform]};
  for (int i = 0; i < kBands; ++i) {
    curve.points.push_back({0.5 * (i + 0.5) / kBands, 100 * look.bands[i] / unit});
  }
  return curve;
}

}  // namespace

Figure targets_figure(const Artist& artist, const Looks& looks, bool sharp) {
  Figure figure;
  for (std::size_t target = 0; target < std::size(kTargets); ++target) {
    const Look& look = looks.find(target, sharp);
    const std::string title = fmt::format("{}, {}", kTargets[target], sharpness(sharp));
    const cli::PixelPanel panel{title, 0, 0, look.frame.width_px(), look.frame.height_px()};
    figure.pictures.push_back(
        artist.draw_script(fmt::format("target-{}-{}", kTargets[target], name_of(look)), title,
                           kWidth, kHeight, kFont, cli::gnuplot_pixels(panel, look.frame)));
  }
  figure.caption = sharp ? "The targets in focus." : "The same, out of focus.";
  return figure;
}

Figure spectra_figure(const Artist& artist, const Looks& looks, bool sharp) {
  const Look& look = looks.find(kChart, sharp);
  const Window& window = look.window;
  const std::string title = "the window, " + sharpness(sharp);
  Figure figure;
  figure.pictures.push_back(artist.draw_script(
      fmt::format("window-{}", name_of(look)), title, kWidth, kHeight, kFont,
      cli::gnuplot_pixels({title, window.x, window.y, window.n, window.n}, look.frame)));
  for (const SpectrumLook& spectrum : look.spectra) {
    const Transform3& transform = kTransforms[spectrum.transform];
    const std::string text = fmt::format("its {} spectrum", transform.short_name);
    figure.pictures.push_back(artist.draw_script(
        fmt::format("spectrum-{}-{}", spectrum.transform == kFft ? "fft" : "walsh", name_of(look)),
        text + ", " + sharpness(sharp), kWidth, kHeight, kFont,
        cli::gnuplot_spectrum(text, MetricSpec::parse(transform.metric), spectrum.coefficients)));
  }
  figure.caption = fmt::format(
      "The 64 x 64 window of the chart, {}. The FFT's spectrum has zero frequency in the middle, "
      "Walsh's in the upper left corner.",
      sharpness(sharp));
  return figure;
}

Figure sums_figure(const Artist& artist, const Looks& looks) {
  Figure figure;
  for (std::size_t i = 0; i < std::size(kShown); ++i) {
    const SpectrumLook& sharp = looks.find(kChart, true).spectra[i];
    const SpectrumLook& blurred = looks.find(kChart, false).spectra[i];
    const std::string title =
        fmt::format("{}: what makes the score", kTransforms[sharp.transform].short_name);
    cli::PlotLabels labels = panel_labels(title, "spatial frequency (cycles per pixel)",
                                          "part of the score in focus (%)", kKeyBelow, 2);
    labels.height_px = 480;
    labels.x_range = {0, 0.5};
    const cli::Curve curves[] = {band_curve(sharp, true, sharp.score),
                                 band_curve(blurred, false, sharp.score)};
    figure.pictures.push_back(artist.draw(
        fmt::format("sums-{}", sharp.transform == kFft ? "fft" : "walsh"), title, curves, labels));
  }
  figure.caption =
      "Mass times squared lever arm, summed over bands of 1/64 cycle per pixel. The area under a "
      "line, with the corners beyond 1/2, is the score.";
  return figure;
}

}  // namespace fathom::reproduce
