// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace fathom::opencl {

/// What the list of OpenCL devices depends on (backends/gpu/drivers.hpp). Empty where there is no
/// loader: then there is nothing to keep.
std::string drivers();

}  // namespace fathom::opencl
