// SPDX-License-Identifier: Apache-2.0
// What a lens does, in numbers (thesis T17): where the image is, how far it is sharp, and what
// blur leaves of its contrast.
//
// Distances are measured from a thin lens, objects in front of it and images behind. Every function
// throws Error(bad_argument) for what no lens has: a length or an f-number that is not above 0, an
// object at or inside the focal length, anything that is not a number. An object may be at
// infinity. Equation numbers are the thesis'.
#pragma once

namespace fathom {

/// What of a lens and a sensor decides how much is in focus.
struct Optics {
  double focal_mm = 0;   ///< Focal length.
  double f_number = 0;   ///< Focal length over the diameter of the aperture.
  double circle_mm = 0;  ///< Circle of confusion: the largest blur on the sensor taken for sharp.

  bool operator==(const Optics&) const = default;
};

namespace optics {

/// Throws Error(bad_argument) unless all three are finite and above 0.
void require_valid(const Optics& optics);

// --- The thin lens ---

/// Where an object comes to focus, mm: f X/(X - f), eq. 3-1 solved for the image.
double image_distance_mm(double focal_mm, double object_mm);

/// The object that is in focus on a sensor at this distance, mm: eq. 3-1 solved for the object.
/// Infinite for a sensor at the focal length; one nearer than that is an error.
double object_distance_mm(double focal_mm, double image_mm);

/// How much farther than for infinity the lens stands from the sensor to focus on an object, mm:
/// f^2/(X - f), which is eq. 3-1 in Newton's form.
double extension_mm(double focal_mm, double object_mm);

/// The object that a lens so far out is focused on, mm: f + f^2/e; infinite at 0.
double object_at_extension_mm(double focal_mm, double extension_mm);

/// Size on the sensor over size of the object: f/(X - f).
double magnification(double focal_mm, double object_mm);

/// f-number of the light that meets the sensor, N (1 + magnification): the lens is farther away
/// than its focal length.
double working_f_number(const Optics& optics, double object_mm);

// --- Depth of field ---

/// Diameter of the disc that a point becomes on a sensor beside its image, mm:
/// (f/N) |sensor - image| / image, by similar triangles (fig. 2).
double disc_of_confusion_mm(double focal_mm, double f_number, double image_mm, double sensor_mm);

/// By how much that disc grows for each mm between sensor and image: 1/(working f-number).
double disc_per_defocus(const Optics& optics, double object_mm);

/// Between which distances an object looks sharp.
struct DepthOfField {
  double near_mm;
  double far_mm;  ///< Infinite from the hyperfocal distance on.

  double total_mm() const { return far_mm - near_mm; }
};

/// Eq. 3-3: X/(1 + X C N/f^2) and X/(1 - X C N/f^2) for a lens focused at X. The thesis takes X for
/// X - f, so the depth comes out too large by about the magnification (a tenth at 1500 mm, 135 mm).
DepthOfField depth_of_field(const Optics& optics, double object_mm);

/// From here on the far limit is infinite, mm: f^2/(C N), where the denominator of eq. 3-3 is 0.
double hyperfocal_mm(const Optics& optics);

/// How far the sensor may be moved, between both ends, with a point still within the circle of
/// confusion, mm: 2 C (working f-number) (fig. 2).
double depth_of_focus_mm(const Optics& optics, double object_mm);

// --- Diffraction and blur ---

/// Radius of the Airy disc, um: 1.22 lambda f/d, eq. 3-2. Of a lens that is not focused at infinity
/// give the image distance for the focal length.
double airy_radius_um(double focal_mm, double aperture_mm, double wavelength_nm);

/// (Imax - Imin)/(Imax + Imin), eq. 3-14. Intensities are not negative and not both 0.
double modulation(double largest, double smallest);

/// Spatial frequency on the sensor from which on no contrast is left, cycles/mm: 1/(lambda N).
double cutoff_cycles_per_mm(double working_f_number, double wavelength_nm);

/// MTF of a perfect lens in focus, circular pupil; the frequency is a part of the cutoff, and from
/// 1 on nothing is left: 2/pi (acos v - v sqrt(1 - v^2)) (Goodman 1968, sec. 6-3).
double diffraction_mtf(double cutoff_part);

/// Path difference between the rim and the middle of the pupil, in wavelengths, that belongs to a
/// disc of confusion: c/(8 lambda N). Hopkins' w20; the curve marked n in the thesis' fig. 4 has
/// n/pi of it.
double defocus_waves(double disc_mm, double working_f_number, double wavelength_nm);

/// Transfer function of a perfect lens out of focus (fig. 4): the autocorrelation of a circular
/// pupil with a quadratic phase (Hopkins 1955), to 1e-10. Real, because the pupil is symmetric;
/// negative where dark and bright change places. Its magnitude is the MTF.
double defocused_otf(double cutoff_part, double waves);

/// The same by rays alone: the transform of a uniform disc, 2 J1(x)/x, with x = pi times the disc's
/// diameter times the frequency. What defocused_otf tends to when defocus is large.
double disc_otf(double x);

}  // namespace optics
}  // namespace fathom
