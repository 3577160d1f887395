// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>

namespace delfront::cli {

/// @brief Ctrl-C and `kill` ask the run to stop at its next cancellation point; a second one ends the process at once.
/// @return the token for Context::cancel
std::atomic<bool>* stop_on_interrupt();

}  // namespace delfront::cli
