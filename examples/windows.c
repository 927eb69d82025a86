/* SPDX-License-Identifier: Apache-2.0 */
/* The focus quality of one window, and of every window of a grid in rings, in C. */
#include <fathom/fathom.h>
#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = 256, HEIGHT = 256, N = 64, COLUMNS = WIDTH / N, WINDOWS = COLUMNS * (HEIGHT / N) };

static unsigned char pixels[WIDTH * HEIGHT];

static int fail(fathom_plan* plan) {
  fprintf(stderr, "windows: %s\n", fathom_error_text());
  fathom_close(plan);
  return 1;
}

static int print_one(void) {
  double score;
  fathom_plan* plan = fathom_open("fft:64:hann", NULL, 1); /* NULL: "auto" */
  if (plan == NULL) return fail(plan);
  if (fathom_score_window(plan, pixels, WIDTH, HEIGHT, 8, 0, 96, 88, &score) != FATHOM_OK)
    return fail(plan);
  printf("%s on %s: %.6g\n", fathom_metric(plan), fathom_device(plan), score);
  fathom_close(plan);
  return 0;
}

static int print_grid(void) {
  fathom_window windows[WINDOWS];
  double* values;
  int i;
  fathom_plan* plan = fathom_open("fft:64:hann:power:rings=8", "cpu", WINDOWS);
  if (plan == NULL) return fail(plan);

  for (i = 0; i < WINDOWS; ++i) {
    windows[i].x = i % COLUMNS * N;
    windows[i].y = i / COLUMNS * N;
    windows[i].n = N;
  }
  values = malloc(WINDOWS * fathom_outputs(plan) * sizeof *values);
  if (values == NULL) {
    fathom_close(plan);
    return 1;
  }
  if (fathom_score(plan, pixels, WIDTH, HEIGHT, 8, 0, windows, WINDOWS, values) != FATHOM_OK) {
    free(values);
    return fail(plan);
  }
  printf("%d windows, %d numbers each; the first of them %.4g\n", WINDOWS,
         (int)fathom_outputs(plan), values[0]);
  free(values);
  fathom_close(plan);
  return 0;
}

int main(void) {
  int i;
  for (i = 0; i < WIDTH * HEIGHT; ++i) pixels[i] = i % 8 < 4 ? 40 : 200; /* your picture */
  return print_one() || print_grid();
}
