// SPDX-License-Identifier: Apache-2.0
// What reading and writing of PNG share.
//
// libpng reports errors by longjmp, which skips destructors. So every call of it stands in the body
// of guarded(), and no such body holds an object that needs one.
#pragma once

#include <png.h>

#include <csetjmp>
#include <cstdio>

namespace fathom::pictures {

/// Where libpng's error function leaves its message before it jumps back.
struct PngTrouble {
  char message[200] = "";
};

[[noreturn]] inline void on_png_error(png_structp png, png_const_charp message) {
  auto* trouble = static_cast<PngTrouble*>(png_get_error_ptr(png));
  std::snprintf(trouble->message, sizeof trouble->message, "%s", message);
  png_longjmp(png, 1);
}

inline void on_png_warning(png_structp, png_const_charp) {}  // damage that matters is an error

/// Runs libpng calls; false if one of them failed.
template <class Body>
bool guarded(png_structp png, Body body) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  body();
  return true;
}

}  // namespace fathom::pictures
