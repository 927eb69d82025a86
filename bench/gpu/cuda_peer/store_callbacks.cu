// SPDX-License-Identifier: Apache-2.0
// cuFFT's store callbacks, one for each side and mass, as load_callbacks.cu. They are a file of
// their own: a plan gets both, and what is linked must not define a function twice.
#include <cufft.h>

#include "callback_math.hpp"

#define PEER_STORE(name, log_n, is_power)                                                         \
  __device__ void name(void*, unsigned long long offset, cufftComplex value, void* info, void*) { \
    fathom::peer::add_coefficient<log_n, is_power>(                                               \
        *static_cast<const fathom::peer::CallbackInfo*>(info), offset, value.x, value.y);         \
  }

#define PEER_STORES(n, log_n)                            \
  PEER_STORE(fathom_store_##n##_magnitude, log_n, false) \
  PEER_STORE(fathom_store_##n##_power, log_n, true)

PEER_STORES(8, 3)
PEER_STORES(16, 4)
PEER_STORES(32, 5)
PEER_STORES(64, 6)
PEER_STORES(128, 7)
PEER_STORES(256, 8)
PEER_STORES(512, 9)
