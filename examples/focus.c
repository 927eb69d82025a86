/* SPDX-License-Identifier: Apache-2.0 */
/* Which of several pictures of one scene is in focus? The C interface in one page.
 *
 *   focus FRAME.pgm...          8-bit binary PGM, all of one scene
 */
#include <fathom/fathom.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct picture {
  int width, height;
  unsigned char* pixels;
} picture;

/* Returns 0 if the file is no 8-bit binary PGM without comments. */
static int read_pgm(const char* name, picture* p) {
  FILE* file = fopen(name, "rb");
  int deepest = 0, whole = 0;
  p->pixels = NULL;
  if (file == NULL) return 0;
  if (fscanf(file, "P5 %d %d %d", &p->width, &p->height, &deepest) == 3 && deepest == 255 &&
      p->width > 0 && p->width <= 32768 && p->height > 0 && p->height <= 32768) {
    const size_t size = (size_t)p->width * (size_t)p->height;
    p->pixels = malloc(size);
    fgetc(file); /* the one space after the header */
    whole = p->pixels != NULL && fread(p->pixels, 1, size, file) == size;
  }
  fclose(file);
  return whole;
}

/* Focus quality of the 64 x 64 pixels in the middle, below 0 on failure. */
static double score_file(fathom_plan* plan, const char* name) {
  picture p;
  double score = -1;
  if (!read_pgm(name, &p)) {
    fprintf(stderr, "focus: cannot read %s as an 8-bit binary PGM\n", name);
  } else if (fathom_score_window(plan, p.pixels, p.width, p.height, 8, 0, p.width / 2 - 32,
                                 p.height / 2 - 32, &score) != FATHOM_OK) {
    fprintf(stderr, "focus: %s: %s\n", name, fathom_error_text());
    score = -1;
  }
  free(p.pixels);
  return score;
}

int main(int argc, char** argv) {
  const char* sharpest = NULL;
  double best = -1;
  int i;
  fathom_plan* plan = fathom_open("walsh-sequency:64", NULL, 1);
  if (plan == NULL) {
    fprintf(stderr, "focus: %s\n", fathom_error_text());
    return 1;
  }
  for (i = 1; i < argc; ++i) {
    const double score = score_file(plan, argv[i]);
    if (score < 0) break;
    printf("%-24s %.6g\n", argv[i], score);
    if (score > best) {
      best = score;
      sharpest = argv[i];
    }
  }
  fathom_close(plan);
  if (sharpest == NULL || i < argc) return 1;
  printf("sharpest: %s\n", sharpest);
  return 0;
}
