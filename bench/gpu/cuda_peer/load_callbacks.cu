// SPDX-License-Identifier: Apache-2.0
// cuFFT's load callbacks, one for each side and depth, for cufftXtSetJITCallback. Compiled to
// LTO-IR, which cuFFT links into its own kernels when a plan is made:
//
//   nvcc -dc -fatbin -gencode arch=compute_90,code=lto_90 load_callbacks.cu -o load.fatbin
//
// cuFFT finds a function by its plain name, so they stand in no namespace.
#include "callback_math.hpp"

#define PEER_LOAD(name, log_n, Pixel)                                          \
  __device__ float name(void*, unsigned long long offset, void* info, void*) { \
    return fathom::peer::load_pixel<log_n, Pixel>(                             \
        *static_cast<const fathom::peer::CallbackInfo*>(info), offset);        \
  }

#define PEER_LOADS(n, log_n)                           \
  PEER_LOAD(fathom_load_##n##_8, log_n, unsigned char) \
  PEER_LOAD(fathom_load_##n##_16, log_n, unsigned short)

PEER_LOADS(8, 3)
PEER_LOADS(16, 4)
PEER_LOADS(32, 5)
PEER_LOADS(64, 6)
PEER_LOADS(128, 7)
PEER_LOADS(256, 8)
PEER_LOADS(512, 9)
