/* SPDX-License-Identifier: Apache-2.0 */
/** \file
 * Fathom from C, and from whatever calls C (Fortran, Python's ctypes, Julia): focus quality of
 * windows of a picture that lies in the caller's memory. What the FOCUS function of the thesis did,
 * in place of it:
 *
 *     fathom_plan *plan = fathom_open("fft:64:hann", NULL, 1);
 *     if (plan == NULL) { puts(fathom_error_text()); return 1; }
 *     double score;
 *     if (fathom_score_window(plan, pixels, 256, 240, 8, 0, 96, 88, &score) != FATHOM_OK)
 *       puts(fathom_error_text());
 *     fathom_close(plan);
 *
 * A larger score is a sharper picture. Scores compare between pictures of one scene, one metric and
 * one depth; what they are is in docs/metrics.md.
 *
 * No function prints, exits or lets a C++ exception out. One plan serves one thread at a time: a
 * call that comes while another thread is in one on the same plan fails with FATHOM_BAD_ARGUMENT.
 * Different plans serve different threads. After a fork, a plan on a GPU serves the parent only; in
 * the child it fails with FATHOM_DEVICE_LOST, and only fathom_close() is of use. A plan on the CPU
 * goes on in the child, on one thread. */
#ifndef FATHOM_FATHOM_H
#define FATHOM_FATHOM_H

#include <stddef.h>

#if defined(__GNUC__)
#define FATHOM_API __attribute__((visibility("default")))
#else
#define FATHOM_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** Why a call failed. FATHOM_OK is 0; the numbers of the others never change. */
typedef enum fathom_status {
  FATHOM_OK = 0,
  FATHOM_BAD_ARGUMENT =
      1, /**< has no meaning: a side of 65, a null pointer, an unreadable metric */
  FATHOM_OUT_OF_BOUNDS = 2, /**< a window that crosses the edge of the picture */
  FATHOM_BAD_DATA = 3,
  FATHOM_IO = 4,
  FATHOM_UNAVAILABLE = 5, /**< no such backend or device; the text lists the choices */
  FATHOM_UNSUPPORTED = 6, /**< a device that cannot compute the metric; the text says why */
  FATHOM_DEVICE_LOST = 7, /**< open a new plan */
  FATHOM_OUT_OF_MEMORY = 8,
  FATHOM_TIMEOUT = 9,
  FATHOM_CANCELLED = 10,
  FATHOM_INTERNAL = 99 /**< a fault of the library itself: please report it */
} fathom_status;

/** An opened device, made ready for one metric. */
typedef struct fathom_plan fathom_plan;

/** A square of pixels: columns x .. x+n-1 and rows y .. y+n-1. n must be the plan's. */
typedef struct fathom_window {
  int x, y, n;
} fathom_window;

/** Opens a device and prepares it for a metric.
 * metric:   TRANSFORM[:N][:TAPER][:power][:band=LO-HI][:rings=K], such as "fft:64:hann" or
 * "walsh-sequency:64", or dct[:N]:entropy[:band=LO-HI]; N is 64 if left out. backend:  "auto", "NAME", "NAME:INDEX" or "NAME:TEXT"
 * (a part of a device's name). NULL or "": what the environment variable FATHOM_BACKEND says, else
 * "auto"; FATHOM_THREADS likewise limits the processors that a backend may keep busy. capacity:
 * most windows of one fathom_score(), at least 1. 1 also tells "auto" to look for the fastest
 * single window, more for the fastest batch. Returns NULL on failure; fathom_error_status() and
 * fathom_error_text() say why. */
FATHOM_API fathom_plan* fathom_open(const char* metric, const char* backend, size_t capacity);

/** Scores windows of a grey picture (thesis eqs. 5-1 and 5-2; rings and entropy:
 * docs/metrics.md).
 * pixels:       top row first. 8 bits: one byte a pixel; 9 to 16 bits: two bytes a pixel in the
 * machine's order, the values as they are, not rescaled. Only read, and only during the call.
 * width, height: of the picture, in pixels.
 * stride_bytes: from the start of a row to the start of the next; 0 for rows without gaps. Need not
 *               be even.
 * windows, count: at most the plan's capacity; they may overlap. count may be 0.
 * scores:       room for count * K numbers, K = fathom_outputs(plan): 1 for all but rings. Those
 *               of windows[i] are scores[i * K] .. scores[i * K + K - 1]. Untouched where the
 *               arguments are refused. */
FATHOM_API fathom_status fathom_score(fathom_plan* plan, const void* pixels, int width, int height,
                                      int bits, size_t stride_bytes, const fathom_window* windows,
                                      size_t count, double* scores);

/** Scores the one window whose upper left pixel is (x, y); its side is the plan's. score: room for
 * fathom_outputs(plan) numbers. */
FATHOM_API fathom_status fathom_score_window(fathom_plan* plan, const void* pixels, int width,
                                             int height, int bits, size_t stride_bytes, int x,
                                             int y, double* score);

/** Numbers that one window gives: 1, or K of a metric with rings=K; 0 for NULL. */
FATHOM_API size_t fathom_outputs(const fathom_plan* plan);

/** The plan's metric in full, such as "fft:64:hann". Stays valid until the plan is closed; "" for
 * NULL. */
FATHOM_API const char* fathom_metric(const fathom_plan* plan);

/** Which device computes and why it was chosen, in one line. Stays valid until the plan is closed;
 * "" for NULL. */
FATHOM_API const char* fathom_device(const fathom_plan* plan);

/** Gives everything back. NULL is nothing to close. */
FATHOM_API void fathom_close(fathom_plan* plan);

/** How this thread's last fathom_open, fathom_score or fathom_score_window ended. */
FATHOM_API fathom_status fathom_error_status(void);

/** Why, in one line; "" after a success. Stays valid until this thread's next call of one of the
 * three. */
FATHOM_API const char* fathom_error_text(void);

/** The library's version, such as "0.2.0". */
FATHOM_API const char* fathom_version(void);

#ifdef __cplusplus
}
#endif

#endif /* FATHOM_FATHOM_H */
