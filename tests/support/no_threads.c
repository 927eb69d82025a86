/* SPDX-License-Identifier: Apache-2.0 */
/* Preloaded into a program, lets it start no thread, as a limit of processes does for all but root. */
#include <errno.h>

int pthread_create(void* thread, const void* attributes, void* (*start)(void*), void* argument) {
  (void)thread, (void)attributes, (void)start, (void)argument;
  return EAGAIN;
}
