// SPDX-License-Identifier: Apache-2.0
// Recordings like a webcam's, and what is left of their focus when most of the pictures are missing.
#pragma once

namespace fathom {

/// Records so many windows, each with 52 pictures at 0, 5 .. 255, and prints how near the focus of
/// every tenth picture is to that of all. Whether four of five are near enough.
bool measure_webcam(int windows, unsigned seed, bool list);

}  // namespace fathom
