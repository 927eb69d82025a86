/* SPDX-License-Identifier: Apache-2.0 */
/* The C interface from C: a known score, and every way to be refused. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "capi/fathom.h"

static int failures = 0;

#define CHECK(condition)                                                                       \
  do {                                                                                         \
    if (!(condition)) {                                                                        \
      printf("%s:%d: not so: %s (%s)\n", __FILE__, __LINE__, #condition, fathom_error_text()); \
      ++failures;                                                                              \
    }                                                                                          \
  } while (0)

enum { WIDTH = 20, HEIGHT = 17 };

static uint8_t picture8[HEIGHT][WIDTH];
static uint16_t picture16[HEIGHT][WIDTH];

/* One bright pixel at (5, 3) on black. Its Walsh coefficients are all +-grey/N^2, so
 * phi = grey/N^6 SUM (i^2 + j^2) = grey/N^6 2 N SUM i^2; for N = 8 SUM i^2 is 140. */
static double impulse_score(double grey) { return grey * 2 * 8 * 140 / 262144.0; }

static void draw(void) {
  memset(picture8, 0, sizeof picture8);
  memset(picture16, 0, sizeof picture16);
  picture8[3][5] = 200;
  picture16[3][5] = 40000;
}

static void check_scores(void) {
  fathom_plan* plan = fathom_open("walsh-sequency:8", "reference", 3);
  fathom_window windows[] = {{0, 0, 8}, {5, 3, 8}, {12, 9, 8}};
  double scores[] = {-1, -1, -1, -1};
  double score = -1;
  CHECK(plan != NULL);
  CHECK(fathom_error_status() == FATHOM_OK && fathom_error_text()[0] == '\0');
  CHECK(strcmp(fathom_metric(plan), "walsh-sequency:8") == 0);
  CHECK(strstr(fathom_device(plan), "reference:0") != NULL);

  CHECK(fathom_score(plan, picture8, WIDTH, HEIGHT, 8, WIDTH, windows, 3, scores) == FATHOM_OK);
  CHECK(scores[0] == impulse_score(200) && scores[1] == impulse_score(200) && scores[2] == 0);
  CHECK(scores[3] == -1);

  CHECK(fathom_score_window(plan, picture16, WIDTH, HEIGHT, 16, 0, 4, 2, &score) == FATHOM_OK);
  CHECK(score == impulse_score(40000));
  score = -1;
  CHECK(fathom_score_window(plan, picture16, WIDTH, HEIGHT, 12, 2 * WIDTH, 4, 2, &score) ==
        FATHOM_OK);
  CHECK(score == impulse_score(40000));
  /* Two rows as one: every other row of the picture. */
  CHECK(fathom_score_window(plan, picture8[1], WIDTH, HEIGHT / 2, 8, 2 * WIDTH, 5, 0, &score) ==
        FATHOM_OK);
  CHECK(score == impulse_score(200));
  CHECK(fathom_score(plan, picture8, WIDTH, HEIGHT, 8, 0, NULL, 0, NULL) == FATHOM_OK);
  fathom_close(plan);
}

static void check_open_refusals(void) {
  static const struct {
    const char *metric, *backend, *text;
    size_t capacity;
    fathom_status status;
  } refusals[] = {
      {NULL, NULL, "metric", 1, FATHOM_BAD_ARGUMENT},
      {"", NULL, "transform", 1, FATHOM_BAD_ARGUMENT},
      {"dst:64", NULL, "dst", 1, FATHOM_BAD_ARGUMENT},
      {"fft:65", NULL, "65", 1, FATHOM_BAD_ARGUMENT},
      {"fft:64:hann", "reference", "", 0, FATHOM_BAD_ARGUMENT},
      {"fft:64:hann", "abacus", "reference", 1, FATHOM_UNAVAILABLE},
      {"fft:64:hann", "reference:7", "reference:0", 1, FATHOM_UNAVAILABLE},
  };
  size_t i;
  for (i = 0; i < sizeof refusals / sizeof refusals[0]; ++i) {
    CHECK(fathom_open(refusals[i].metric, refusals[i].backend, refusals[i].capacity) == NULL);
    CHECK(fathom_error_status() == refusals[i].status);
    CHECK(strstr(fathom_error_text(), refusals[i].text) != NULL);
    CHECK(fathom_error_text()[0] != '\0');
  }
}

static void check_score_refusals(void) {
  fathom_plan* plan = fathom_open("fft:8", "reference", 1);
  const fathom_window good = {0, 0, 8}, wide = {0, 0, 16}, two[] = {{0, 0, 8}, {0, 0, 8}};
  double scores[] = {-1, -1};
  CHECK(plan != NULL);
#define REFUSED(status, call)                  \
  do {                                         \
    CHECK((call) == (status));                 \
    CHECK(fathom_error_status() == (status));  \
    CHECK(fathom_error_text()[0] != '\0');     \
    CHECK(scores[0] == -1 && scores[1] == -1); \
  } while (0)
  REFUSED(FATHOM_BAD_ARGUMENT, fathom_score(NULL, picture8, WIDTH, HEIGHT, 8, 0, &good, 1, scores));
  REFUSED(FATHOM_BAD_ARGUMENT, fathom_score(plan, NULL, WIDTH, HEIGHT, 8, 0, &good, 1, scores));
  REFUSED(FATHOM_BAD_ARGUMENT, fathom_score(plan, picture8, WIDTH, HEIGHT, 8, 0, NULL, 1, scores));
  REFUSED(FATHOM_BAD_ARGUMENT, fathom_score(plan, picture8, WIDTH, HEIGHT, 8, 0, &good, 1, NULL));
  REFUSED(FATHOM_BAD_ARGUMENT, fathom_score(plan, picture8, 0, HEIGHT, 8, 0, &good, 1, scores));
  REFUSED(FATHOM_BAD_ARGUMENT, fathom_score(plan, picture8, WIDTH, -1, 8, 0, &good, 1, scores));
  REFUSED(FATHOM_BAD_ARGUMENT, fathom_score(plan, picture8, WIDTH, HEIGHT, 7, 0, &good, 1, scores));
  REFUSED(FATHOM_BAD_ARGUMENT,
          fathom_score(plan, picture8, WIDTH, HEIGHT, 17, 0, &good, 1, scores));
  REFUSED(FATHOM_BAD_ARGUMENT,
          fathom_score(plan, picture8, WIDTH, HEIGHT, 8, WIDTH - 1, &good, 1, scores));
  REFUSED(FATHOM_BAD_ARGUMENT, fathom_score(plan, picture8, WIDTH, HEIGHT, 8, 0, &wide, 1, scores));
  REFUSED(FATHOM_BAD_ARGUMENT, fathom_score(plan, picture8, WIDTH, HEIGHT, 8, 0, two, 2, scores));
  REFUSED(FATHOM_OUT_OF_BOUNDS,
          fathom_score_window(plan, picture8, WIDTH, HEIGHT, 8, 0, 13, 0, scores));
  REFUSED(FATHOM_OUT_OF_BOUNDS,
          fathom_score_window(plan, picture8, WIDTH, HEIGHT, 8, 0, 0, -1, scores));
  REFUSED(FATHOM_BAD_ARGUMENT,
          fathom_score_window(NULL, picture8, WIDTH, HEIGHT, 8, 0, 0, 0, scores));
  CHECK(fathom_score(plan, picture8, WIDTH, HEIGHT, 8, 0, &good, 1, scores) == FATHOM_OK);
  CHECK(scores[0] > 0 && fathom_error_status() == FATHOM_OK && fathom_error_text()[0] == '\0');
  fathom_close(plan);
}

int main(void) {
  draw();
  check_scores();
  check_open_refusals();
  check_score_refusals();
  fathom_close(NULL);
  CHECK(strcmp(fathom_metric(NULL), "") == 0 && strcmp(fathom_device(NULL), "") == 0);
  CHECK(fathom_version()[0] >= '0' && fathom_version()[0] <= '9');
  printf("%d failures\n", failures);
  return failures == 0 ? 0 : 1;
}
