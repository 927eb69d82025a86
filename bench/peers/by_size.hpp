// SPDX-License-Identifier: Apache-2.0
// One instance of a peer per N, so that its loops know their lengths.
#pragma once

#include <memory>
#include <stdexcept>

#include "bench/peers/peer.hpp"

namespace fathom::bench {

/// Makes PeerOf<n>(planning).
template <template <int> class PeerOf>
std::unique_ptr<PreparedPeer> prepare_by_size(int n, Planning planning) {
  switch (n) {
    case 8:
      return std::make_unique<PeerOf<8>>(planning);
    case 16:
      return std::make_unique<PeerOf<16>>(planning);
    case 32:
      return std::make_unique<PeerOf<32>>(planning);
    case 64:
      return std::make_unique<PeerOf<64>>(planning);
    case 128:
      return std::make_unique<PeerOf<128>>(planning);
    case 256:
      return std::make_unique<PeerOf<256>>(planning);
    case 512:
      return std::make_unique<PeerOf<512>>(planning);
    default:
      throw std::invalid_argument("no peer takes this window side");
  }
}

}  // namespace fathom::bench
