// SPDX-License-Identifier: Apache-2.0
// The tables of the peers, in single precision as they are used. Compiled without the peers' own
// flags, so that nothing here depends on them.
#pragma once

#include <vector>

namespace fathom::bench {

/// The hann taper along one axis.
std::vector<float> hann_taper(int n);

/// N^4 times the weight of each coefficient of FFTW's half plane, [v][u] with u = 0 .. n/2:
/// interior columns stand for two coefficients, u = 0 and u = n/2 for themselves; half of r^2 each
/// (eq. 5-1).
std::vector<float> half_plane_weights(int n);

/// N^4 times the weight of each coefficient of an n * n point Walsh-Hadamard transform in natural
/// order, where metric walsh-sequency wants it (eq. 5-2).
std::vector<float> natural_order_weights(int n);

/// What makes FFTW's cosine transform orthonormal but for a factor, [i][j]: the first row and column
/// come out the root of 2 too large.
std::vector<float> orthonormal_weights(int n);

/// 1 / N^6: the transform's and the moment's factors together.
double score_factor(int n);

}  // namespace fathom::bench
