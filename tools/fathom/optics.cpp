// SPDX-License-Identifier: Apache-2.0
// fathom optics: what a lens can tell apart, in numbers (thesis T17).
#include "engine/optics.hpp"

#include <cmath>
#include <filesystem>

#include "engine/error.hpp"
#include "engine/thin_lens_depth.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/optics_figures.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {
namespace {

struct Arguments {
  Optics optics{0, 0, 0.04};  // the thesis' pixels
  double distance_mm = 0;
  double wavelength_nm = 550;  // green, where the thesis has it
  std::string plot;
  bool json = false;
};

/// Everything that the verb says of a lens.
struct Answer {
  double image_mm, extension_mm, magnification;
  double airy_um, airy_here_um;  ///< Focused at infinity, and where it is.
  double disc_per_defocus;
  optics::DepthOfField depth;
  double half_percent;  ///< Half of the depth of field, of the distance.
  double hyperfocal_mm, depth_of_focus_mm;
  double working_f_number;
  optics::DepthOfField exact;  ///< Without the thesis' approximation.
};

Answer answer_of(const Optics& lens, double distance_mm, double wavelength_nm) {
  optics::require_valid(lens);
  const double image_mm = optics::image_distance_mm(lens.focal_mm, distance_mm);
  const double aperture_mm = lens.focal_mm / lens.f_number;
  const optics::DepthOfField depth = optics::depth_of_field(lens, distance_mm);
  const double half_mm = depth.total_mm() / 2;
  return {image_mm,
          optics::extension_mm(lens.focal_mm, distance_mm),
          optics::magnification(lens.focal_mm, distance_mm),
          optics::airy_radius_um(lens.focal_mm, aperture_mm, wavelength_nm),
          optics::airy_radius_um(image_mm, aperture_mm, wavelength_nm),
          optics::disc_per_defocus(lens, distance_mm),
          depth,
          std::isfinite(half_mm) ? 100 * half_mm / distance_mm : half_mm,
          optics::hyperfocal_mm(lens),
          optics::depth_of_focus_mm(lens, distance_mm),
          optics::working_f_number(lens, distance_mm),
          optics::thin_lens_depth_of_field(lens, distance_mm)};
}

std::string json_of(const Arguments& arguments, const Answer& answer) {
  return JsonLine()
      .add("focal_mm", arguments.optics.focal_mm)
      .add("f_number", arguments.optics.f_number)
      .add("distance_mm", arguments.distance_mm)
      .add("circle_mm", arguments.optics.circle_mm)
      .add("wavelength_nm", arguments.wavelength_nm)
      .add("image_mm", answer.image_mm)
      .add("extension_mm", answer.extension_mm)
      .add("magnification", answer.magnification)
      .add("airy_radius_um", answer.airy_um)
      .add("airy_radius_here_um", answer.airy_here_um)
      .add("disc_mm_per_mm_defocus", answer.disc_per_defocus)
      .add("near_mm", answer.depth.near_mm)
      .add("far_mm", answer.depth.far_mm)
      .add("depth_of_field_mm", answer.depth.total_mm())
      .add("half_depth_percent", answer.half_percent)
      .add("hyperfocal_mm", answer.hyperfocal_mm)
      .add("depth_of_focus_mm", answer.depth_of_focus_mm)
      .add("working_f_number", answer.working_f_number)
      .add("exact_near_mm", answer.exact.near_mm)
      .add("exact_far_mm", answer.exact.far_mm)
      .add("exact_depth_of_field_mm", answer.exact.total_mm())
      .text();
}

/// A number with its unit, or that there is no end to it.
std::string quantity(double value, const char* unit, int digits) {
  if (std::isinf(value)) return "infinite";
  return fmt::format("{:.{}g} {}", value, digits, unit);
}

std::string text_of(const Arguments& arguments, const Answer& answer) {
  const auto row = [](const char* name, const std::string& value, const std::string& meaning) {
    return fmt::format("{:<19}  {:<12}  {}\n", name, value, meaning);
  };
  const auto mm = [](double value, int digits) { return quantity(value, "mm", digits); };
  const Optics& lens = arguments.optics;
  return fmt::format(
             "{:g} mm lens at f/{:g}, focused on {}, circle of confusion {:g} mm, {:g} nm\n",
             lens.focal_mm, lens.f_number,
             std::isinf(arguments.distance_mm) ? "infinity" : mm(arguments.distance_mm, 6),
             lens.circle_mm, arguments.wavelength_nm) +
         row("image distance", mm(answer.image_mm, 6), "from the lens to a sensor in focus") +
         row("extension", mm(answer.extension_mm, 6), "farther out than for infinity") +
         row("magnification", fmt::format("{:.4g}", answer.magnification),
             "size on the sensor over size of the object") +
         row("working f-number", fmt::format("{:.4g}", answer.working_f_number),
             "of the light that meets the sensor") +
         row("Airy radius", quantity(answer.airy_um, "um", 3),
             fmt::format("diffraction blurs a point by this, focused at infinity; here {}",
                         quantity(answer.airy_here_um, "um", 3))) +
         row("disc of confusion", fmt::format("{:.3g} mm/mm", answer.disc_per_defocus),
             "diameter that a point grows to, for each mm the sensor is out of focus") +
         row("near limit", mm(answer.depth.near_mm, 6), "nearest object that looks sharp") +
         row("far limit", mm(answer.depth.far_mm, 6), "farthest object that looks sharp") +
         row("depth of field", mm(answer.depth.total_mm(), 4),
             "between the two, by the thesis' formula (3-3)") +
         row("depth, exact", mm(answer.exact.total_mm(), 4),
             fmt::format("of a thin lens, from {} to {}", mm(answer.exact.near_mm, 6),
                         mm(answer.exact.far_mm, 6))) +
         row("half of it", quantity(answer.half_percent, "%", 3),
             "of the distance: how far off an object that looks sharp may be") +
         row("hyperfocal distance", mm(answer.hyperfocal_mm, 6),
             "focused there, all from half of it to infinity looks sharp") +
         row("depth of focus", mm(answer.depth_of_focus_mm, 3),
             "the sensor may be half of this off, either way");
}

/// Before anything is computed, so that a name that cannot be a folder leaves no half of an answer.
void require_folder(const std::string& folder) {
  if (folder == "-") {
    throw Error(ErrorCode::bad_argument,
                "cannot draw three figures in the terminal; name a folder for them after --plot");
  }
  const std::string extension = std::filesystem::path(folder).extension();
  if (extension == ".svg" || extension == ".png") {
    throw Error(ErrorCode::bad_argument, "three figures do not fit in the file " + folder +
                                             "; name a folder for them after --plot");
  }
}

int run(const Arguments& arguments) {
  require_folder(arguments.plot);
  const Answer answer = answer_of(arguments.optics, arguments.distance_mm, arguments.wavelength_nm);
  if (!arguments.plot.empty()) {
    write_optics_figures(arguments.plot, arguments.optics, arguments.distance_mm,
                         arguments.wavelength_nm);
  }
  if (arguments.json) {
    print_line(json_of(arguments, answer));
    return kDone;
  }
  print_lines(text_of(arguments, answer));
  if (!arguments.plot.empty()) {
    print_line(
        fmt::format("figures 3, 4 and 14 of the thesis for this lens are in {}", arguments.plot));
  }
  return kDone;
}

}  // namespace

void add_optics(Verb& program) {
  Verb verb =
      program.add_verb("optics", "Say what a lens can tell apart: depth of field and the like");
  verb.set_footer(
      "Example:\n  fathom optics --focal 135 --fnumber 4 --distance 1500 --plot figures\n\n"
      "docs/optics.md has the formulas.");
  auto arguments = std::make_shared<Arguments>();
  verb.add_option("--focal", arguments->optics.focal_mm, "Focal length in mm").required();
  verb.add_option("--fnumber", arguments->optics.f_number, "f-number: 4 for f/4").required();
  verb.add_option("--distance", arguments->distance_mm,
                  "Distance from the lens that it is focused on, in mm; inf for infinity")
      .required();
  verb.add_option("--coc", arguments->optics.circle_mm,
                  "Circle of confusion in mm: the largest blur taken for sharp; the pixel pitch "
                  "for a camera")
      .shows_default();
  verb.add_option("--wavelength", arguments->wavelength_nm, "Wavelength of the light in nm")
      .shows_default();
  verb.add_option("--plot", arguments->plot,
                  "Folder for the thesis' figures 3, 4 and 14 for this lens, as SVG");
  verb.add_flag("--json", arguments->json, "One JSON object on standard output");
  verb.on_run([arguments] { return run(*arguments); });
}

}  // namespace fathom::cli
