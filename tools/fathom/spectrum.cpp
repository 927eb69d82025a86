// SPDX-License-Identifier: Apache-2.0
// fathom spectrum: the picture of a window's spectrum (thesis T6).
#include "engine/spectrum_picture.hpp"

#include "backends/backends.hpp"
#include "engine/error.hpp"
#include "engine/selection.hpp"
#include "engine/windowed_metric.hpp"
#include "pictures/picture.hpp"
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/plot.hpp"
#include "tools/fathom/run_keeping.hpp"
#include "tools/fathom/spectrum_figure.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {
namespace {

struct Arguments {
  std::string image;
  MetricArguments metric;
  std::size_t page = 0;
  bool decibel = false;
  std::string output;
  std::string figure;
};

/// Before anything is computed.
void require_outputs(const Arguments& arguments) {
  require_separate({arguments.image}, {arguments.output, arguments.figure});
  if (arguments.output.empty() && arguments.figure.empty()) {
    throw Error(ErrorCode::bad_argument,
                "nothing to draw; name a picture with -o, or a figure with axes with --plot");
  }
  if (arguments.figure == "-") {
    throw Error(ErrorCode::bad_argument,
                "a spectrum cannot be drawn in the terminal; name a file ending in .svg or .png");
  }
  require_plot_target(arguments.figure);
}

void write_spectrum(const Arguments& arguments, const WindowedMetric& aim,
                    const std::vector<std::complex<double>>& coefficients) {
  const auto scale = arguments.decibel ? MagnitudeScale::decibel : MagnitudeScale::linear;
  const Frame picture = spectrum_picture(aim.spec.transform, aim.spec.n, coefficients, scale);
  write_picture(arguments.output, picture);
  print_line(fmt::format(
      "{} x {} px spectrum of {} window {} written to {} ({})", picture.width_px(),
      picture.height_px(), aim.spec.text(), to_string(aim.window), arguments.output,
      arguments.decibel ? fmt::format("{:g} dB below the peak is black", kSpectrumRange_dB)
                        : std::string("linear")));
}

int run(const Arguments& arguments) {
  require_outputs(arguments);
  const Frame frame = read_picture(arguments.image, arguments.page);
  const WindowedMetric aim =
      resolve_window(arguments.metric.metric, arguments.metric.chosen_window(), frame.width_px(),
                     frame.height_px());
  const Selection selection =
      select_device(all_backends(), arguments.metric.backend, aim.spec, 1, arguments.metric.device);
  std::vector<std::complex<double>> coefficients(static_cast<std::size_t>(aim.spec.n) * aim.spec.n);
  selection.device->plan(aim.spec, 1)->spectrum(frame, aim.window, coefficients);
  if (!arguments.output.empty()) write_spectrum(arguments, aim, coefficients);
  if (!arguments.figure.empty()) {
    write_spectrum_figure(arguments.figure, frame, aim.window, aim.spec, coefficients);
    print_line(fmt::format("window {} and its {} spectrum drawn in {}", to_string(aim.window),
                           aim.spec.text(), arguments.figure));
  }
  return kDone;
}

}  // namespace

void add_spectrum(Verb& program) {
  Verb verb = program.add_verb("spectrum", "Draw the spectrum of a window");
  verb.set_footer(
      "Examples:\n  fathom spectrum photo.png --window 96,88,64 --plot spectrum.png\n"
      "  fathom spectrum photo.png --window 96,88,64 --db -o coefficients.png");
  auto arguments = std::make_shared<Arguments>();
  verb.add_option("image", arguments->image, "PNG, JPEG, TIFF or PGM file").required();
  arguments->metric.add_to(verb);
  verb.add_option("--page", arguments->page, "Page of a multi-page TIFF, from 0").shows_default();
  verb.add_flag("--db", arguments->decibel, "Of -o: decibels instead of a linear scale");
  verb.add_option("-o,--output", arguments->output,
                  "Picture with a pixel for each coefficient: .png, .tif or .pgm");
  verb.add_option("--plot", arguments->figure,
                  "FILE.svg or FILE.png: the window and its spectrum in dB, with axes");
  verb.on_run([arguments] { return run(*arguments); });
}

}  // namespace fathom::cli
