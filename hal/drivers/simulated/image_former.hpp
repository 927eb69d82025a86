// SPDX-License-Identifier: Apache-2.0
// From a scene to the light on the sensor's pixels.
//
// Blur is a convolution, so it is done in the frequency domain: each layer is transformed once, and
// each picture multiplies it with the transfer function of its disc of confusion, folds the
// frequencies beyond the pixels' own back (aliasing, as on a real sensor) and transforms it back.
// The field repeats beyond its edges: light that is blurred out on the left comes in on the right.
#pragma once

#include <complex>
#include <memory>
#include <span>
#include <vector>

#include "hal/drivers/simulated/scene.hpp"

namespace fathom::simulated {

class ImageFormer {
 public:
  explicit ImageFormer(const Scene& scene);
  ~ImageFormer();
  ImageFormer(ImageFormer&&) noexcept;
  ImageFormer& operator=(ImageFormer&&) noexcept;

  /// Mean reflectance that each pixel sees, [row][col] of kHeightPx x kWidthPx: the layers, each
  /// with its disc of confusion (diameters on the sensor in mm, in the scene's order), over the
  /// grey card, seen through square pixels without gaps.
  std::vector<float> picture(std::span<const double> disc_diameters_mm);

 private:
  class Transforms;
  using Field = std::vector<std::complex<float>>;

  std::unique_ptr<Transforms> transforms_;
  /// Per layer, [row][col] of kFieldCells squared, pixel aperture applied.
  std::vector<Field> spectra_;
};

}  // namespace fathom::simulated
