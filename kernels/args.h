// SPDX-License-Identifier: Apache-2.0
// What host and kernels agree on; included by C++, GLSL and OpenCL C.
#ifndef FATHOM_KERNELS_ARGS_H_
#define FATHOM_KERNELS_ARGS_H_

#ifdef __cplusplus
#include <cstdint>
namespace fathom::kernels {
#define FATHOM_UINT std::uint32_t
#else
#define FATHOM_UINT uint
#endif

// Push constants, or the last argument: one dispatch over windows first_window .. first_window +
// windows - 1.
struct ScoreArgs {
  FATHOM_UINT first_window;     // of the batch
  FATHOM_UINT windows;          // how many, or 0: those that the list of doubtful windows names
  FATHOM_UINT stride_words;     // four bytes each, from one row of pixels to the next
  FATHOM_UINT bytes_per_pixel;  // 1 or 2
  FATHOM_UINT band_above;       // coefficients count if band_above < squared radius <= band_to
  FATHOM_UINT band_to;
  // is_doubtful of fft.comp and fft.cl, in the units of the kernel. Of rings, noise and tolerance.
  float noise;      // of a coefficient, per root of the energy; with POWER of the score, per energy
  float spread;     // of the score, per noise of a coefficient, whose phase is random
  float in_phase;   // the same where it is not
  float tolerance;  // relative
};

// The arguments of an OpenCL kernel, in this order, and ScoreArgs after them.
#define FATHOM_FRAME 0     // uint[]: rows of pixels, each from a multiple of four bytes on
#define FATHOM_WINDOWS 1   // uint[window]: byte of the frame where the window's first pixel is
#define FATHOM_SCORES 2    // uvec2[window]: see each kernel
#define FATHOM_TABLES 3    // float[] or uint[]: see each kernel
#define FATHOM_SCRATCH 4   // per workgroup: what does not fit on chip
#define FATHOM_DOUBTFUL 5  // uint[]: how many windows float is not to be trusted with, which ones
#define FATHOM_SPECTRUM 6  // vec2[row][column]: coefficients of window 0, for Plan::spectrum
#define FATHOM_ARGUMENTS 7

// Vulkan's storage buffers, by binding. Every device has four, so some hold two things.
#define FATHOM_BINDING_FRAME 0     // uint[window] as FATHOM_WINDOWS, then the frame's rows
#define FATHOM_BINDING_RESULTS 1   // the scores or, where they are wanted instead, the spectrum
#define FATHOM_BINDING_WORK 2      // the tables, FATHOM_TABLE_BYTES() of them, then scratch memory
#define FATHOM_BINDING_DOUBTFUL 3  // as FATHOM_DOUBTFUL
#define FATHOM_BINDINGS 4

// Room for the tables of any metric; those of rings know every coefficient. Scratch memory starts
// behind it.
#define FATHOM_TABLE_BYTES(n) (24576 + (n) * (n))

// Specialisation constants, by id; in OpenCL C macros of the same names without FATHOM_.
#define FATHOM_WORKGROUP 0  // threads of a workgroup
#define FATHOM_N 1          // side of the window
#define FATHOM_POINTS 2     // of a line of N that one thread holds in registers
#define FATHOM_LINES 3      // lines, pairs of columns or of rows, that are on chip at once
#define FATHOM_TEAMS 4      // windows that share a workgroup
#define FATHOM_TOUCHED 5    // highest frequency that a constant under the taper has
#define FATHOM_POWER 6      // mass is |F|^2
#define FATHOM_BANDED 7     // only a band of coefficients counts
#define FATHOM_PLANES 8     // 32-bit planes that a coefficient of integers takes: 1 or 2
#define FATHOM_IS_WALSH 9   // of exact.comp
#define FATHOM_WANTED 10    // what comes out: FATHOM_SCORE or FATHOM_COEFFICIENTS
#define FATHOM_BYTES 11     // of a pixel; the fast kernels have a variant for each
#define FATHOM_PADDED 12    // rows of a pool lie one number further apart than they are long
#define FATHOM_LANES 13  // of OpenCL: neighbouring lines that one thread takes at once, as a vector
#define FATHOM_ON_CHIP 14    // of OpenCL: the scratch memory is the workgroup's shared memory
#define FATHOM_RINGS 15      // sums of masses by rings come out, so many; 0: a moment of inertia
#define FATHOM_LESS_MEAN 16  // of exact.comp: the weighted mean is subtracted before the taper
#define FATHOM_IS_COSINE 17  // of exact.comp
#define FATHOM_ENTROPY 18    // of exact.comp: an entropy comes out
#define FATHOM_CONSTANTS 19

// Columns of a table of rings beyond those that there are: what vectors reach over the end.
#define FATHOM_RING_MARGIN 16

#define FATHOM_SCORE 0
#define FATHOM_COEFFICIENTS 1

#ifdef __cplusplus
static_assert(sizeof(ScoreArgs) == 10 * 4);
}  // namespace fathom::kernels
#endif
#endif
