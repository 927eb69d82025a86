// SPDX-License-Identifier: Apache-2.0
#include "hal/lens.hpp"

#include <fmt/format.h>

#include "engine/error.hpp"

namespace fathom {

void Lens::declare_at(double) {
  throw Error(ErrorCode::unsupported,
              fmt::format("{} knows by itself where it stands", info().description));
}

}  // namespace fathom
