// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/backend.hpp"

namespace fathom::cli {

/// For DeviceOptions::on_work: says on stderr what takes longer than a moment, while it does, and
/// each thing once. For one thread at a time.
OnWork patient_words();

}  // namespace fathom::cli
