// SPDX-License-Identifier: Apache-2.0
#include "depth/interruption.hpp"

#include <utility>

namespace fathom {
namespace {

/// Of each thread: a loop that ends is that of the caller, whoever else computes.
thread_local const std::function<void()>* current = nullptr;

}  // namespace

Interruptible::Interruptible(std::function<void()> look)
    : look_(std::move(look)), before_(std::exchange(current, &look_)) {}

Interruptible::~Interruptible() { current = before_; }

void depth::look_for_interruption() {
  if (current) (*current)();
}

}  // namespace fathom
