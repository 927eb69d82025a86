// SPDX-License-Identifier: Apache-2.0
// The instruction sets that kernels are compiled for. Include it before Highway.
//
// FATHOM_CPU_TARGETS(X) calls X(namespace, bit, name, details) for each, best first. Sets that lie
// between two of these (SSSE3, the additions to AVX-512) would cost compile time and gain nothing;
// vectors of unknown length (SVE, RISC-V) would need other kernels; and the kernels need at least
// 128-bit registers, so that Highway's scalar emulation is out. A processor that has none of them
// lists no device, and `reference` computes.
#pragma once

#define HWY_DISABLED_TARGETS                                                              \
  (HWY_SCALAR | HWY_EMU128 | HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | \
   HWY_SVE2_128 | HWY_RVV)
#if defined(__x86_64__)
#define HWY_BASELINE_TARGETS HWY_SSE4  // the least that is compiled, whatever -march says
#endif

#if defined(__aarch64__) && !defined(TOOLCHAIN_MISS_SYS_AUXV_H)
// Where Highway could choose at run time (GCC on Linux) it compiles for NEON with the cryptography
// extension, which a Raspberry Pi 4 has not. There is nothing to choose, and nothing here needs
// that: told so, Highway compiles for the NEON that every 64-bit ARM has, as it does with clang.
#define TOOLCHAIN_MISS_SYS_AUXV_H
#endif
#include <hwy/detect_targets.h>

#if HWY_TARGETS & HWY_AVX3
#define FATHOM_CPU_AVX3(X) X(N_AVX3, HWY_AVX3, "AVX-512", "512-bit registers")
#else
#define FATHOM_CPU_AVX3(X)
#endif
#if HWY_TARGETS & HWY_AVX2
#define FATHOM_CPU_AVX2(X) X(N_AVX2, HWY_AVX2, "AVX2", "256-bit registers")
#else
#define FATHOM_CPU_AVX2(X)
#endif
#if HWY_TARGETS & HWY_SSE4
#define FATHOM_CPU_SSE4(X) X(N_SSE4, HWY_SSE4, "SSE4", "128-bit registers")
#else
#define FATHOM_CPU_SSE4(X)
#endif
#if HWY_TARGETS & HWY_NEON
#define FATHOM_CPU_NEON(X) X(N_NEON, HWY_NEON, "NEON", "128-bit registers")
#else
#define FATHOM_CPU_NEON(X)
#endif
#define FATHOM_CPU_TARGETS(X) \
  FATHOM_CPU_AVX3(X) FATHOM_CPU_AVX2(X) FATHOM_CPU_SSE4(X) FATHOM_CPU_NEON(X)
