// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <functional>

namespace delfront {

/// @brief Run `task(0) … task(num_tasks - 1)` on up to `threads` threads, the caller's among them; returns when all are
/// done.
///
/// Which thread runs which task is open: a task may write only what no other task reads or writes. So the result cannot
/// depend on the number of threads, as long as the tasks themselves do not.
/// @throws what the first failing task (by number) threw; the others still run to their end
void parallel_for(int threads, std::size_t num_tasks, const std::function<void(std::size_t)>& task);

/// @brief The same over ranges [first, last) of at most `grain` items out of `size`: for plain loops over arrays.
void parallel_ranges(int threads, std::size_t size, std::size_t grain,
                     const std::function<void(std::size_t first, std::size_t last)>& body);

}  // namespace delfront
