// SPDX-License-Identifier: Apache-2.0
#include "bench/peers/peer.hpp"

namespace fathom::bench {

std::span<const Peer> all_peers() {
  static const Peer peers[] = {
      {"peer-fftw", Transform::fft, prepare_fftw},
      {"peer-fftw-walsh", Transform::walsh_sequency, prepare_fftw_walsh},
      {"peer-radix2-walsh", Transform::walsh_sequency, prepare_radix2_walsh},
      {"peer-radix2-int-walsh", Transform::walsh_sequency, prepare_radix2_int_walsh},
  };
  return peers;
}

}  // namespace fathom::bench
