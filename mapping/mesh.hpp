// SPDX-License-Identifier: Apache-2.0
// The map as a surface in space, for other programs.
#pragma once

#include <string>

#include "mapping/depth_result.hpp"

namespace fathom::mapping {

/// How pixels become lengths.
struct MeshScale {
  /// Side of a pixel over its distance from the lens, for a map in mm of a lens whose optics are
  /// known: x and y are then mm. 0: x and y are pixels.
  double px_angle = 0;
  /// Pixels from one vertex to the next.
  int step = 1;
};
/// Few enough vertices for a viewer, some half a million at most.
MeshScale mesh_scale(const DepthResult& result);

/// A binary PLY of vertices with colour, class and sigma, and of triangles between neighbours that
/// are no cliff. y points up, z towards the eye where the map is of distances.
std::string ply_of(const DepthResult& result, const MeshScale& scale);
/// The same surface as a Wavefront OBJ, with the colours behind the coordinates, as many programs
/// read them.
std::string obj_of(const DepthResult& result, const MeshScale& scale);

}  // namespace fathom::mapping
