// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <sys/types.h>

#include <atomic>

namespace delfront::cli {

/// @brief Ctrl-C and `kill` ask the run to stop at its next cancellation point; a second one ends the process at once.
/// @return the token for Context::cancel
std::atomic<bool>* stop_on_interrupt();

/// @brief From now on this is the token; two processes may share it, and each may be interrupted.
/// @param child  what the second interruption of this process ends, instead of the process itself; 0: none
void share_interrupt(std::atomic<bool>* token, pid_t child = 0);

}  // namespace delfront::cli
