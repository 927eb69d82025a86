// SPDX-License-Identifier: Apache-2.0
#include "engine/one_thread.hpp"

#include "engine/error.hpp"

namespace fathom {

void OneThread::Inside::refuse() {
  throw Error(ErrorCode::bad_argument,
              "two threads use one plan at the same time; make a plan for each thread");
}

}  // namespace fathom
