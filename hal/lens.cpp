// SPDX-License-Identifier: Apache-2.0
#include "hal/lens.hpp"

#include <fmt/format.h>

#include "engine/error.hpp"

namespace fathom {

std::unique_ptr<Motion> Lens::start(double) {
  throw Error(ErrorCode::unsupported, fmt::format("{} cannot be watched while it moves: {}",
                                                  info().description, why_unwatched()));
}

std::string Lens::why_unwatched() const { return "it tells where it is only at rest"; }

void Lens::declare_at(double) {
  throw Error(ErrorCode::unsupported,
              fmt::format("{} knows by itself where it stands", info().description));
}

}  // namespace fathom
