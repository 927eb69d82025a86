// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace fathom::opencl {

/// The text of a file in kernels/ ("fft.cl"), as it was when Fathom was built, with what it
/// includes in place of the lines that do. Throws std::out_of_range for a file that was not built
/// in.
std::string source(std::string_view file);

}  // namespace fathom::opencl
