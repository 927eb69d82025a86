// SPDX-License-Identifier: Apache-2.0
#include <fitsio.h>

#include <cstdlib>

#include "engine/error.hpp"
#include "fake_server.hpp"

namespace fathom::test {

std::string make_fits(int type, const std::vector<long>& sides, const std::vector<double>& pixels) {
  std::size_t size = 2880;
  void* memory = std::malloc(size);
  fitsfile* file = nullptr;
  int status = 0;
  std::vector<long> axes = sides;
  std::vector<double> values = pixels;
  fits_create_memfile(&file, &memory, &size, 2880, std::realloc, &status);
  fits_create_img(file, type, static_cast<int>(axes.size()), axes.data(), &status);
  if (!values.empty()) {
    fits_write_img(file, TDOUBLE, 1, static_cast<LONGLONG>(values.size()), values.data(), &status);
  }
  fits_close_file(file, &status);
  std::string bytes(static_cast<const char*>(memory), size);
  std::free(memory);
  if (status != 0) throw Error(ErrorCode::io, "the test cannot make a FITS picture");
  return bytes;
}

}  // namespace fathom::test
