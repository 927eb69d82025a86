// SPDX-License-Identifier: Apache-2.0
#include "depth/maps.hpp"

namespace fathom {

const char* to_string(DepthClass value) noexcept {
  switch (value) {
    case DepthClass::known:
      return "known";
    case DepthClass::filled:
      return "filled";
    case DepthClass::no_texture:
      return "no-texture";
    case DepthClass::two_depths:
      return "two-depths";
    case DepthClass::at_end:
      return "at-end";
    case DepthClass::outside:
      return "outside";
  }
  return "unknown";
}

}  // namespace fathom
