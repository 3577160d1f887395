// SPDX-License-Identifier: Apache-2.0
#include "base/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <limits>
#include <mutex>
#include <thread>
#include <vector>

namespace delfront {

void parallel_for(int threads, std::size_t num_tasks, const std::function<void(std::size_t)>& task) {
  const std::size_t workers = std::min(num_tasks, static_cast<std::size_t>(std::max(threads, 1)));
  if (workers <= 1) {
    for (std::size_t i = 0; i < num_tasks; ++i) task(i);
    return;
  }
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::exception_ptr failure;
  std::size_t failed = std::numeric_limits<std::size_t>::max();
  auto work = [&] {
    for (std::size_t i = next++; i < num_tasks; i = next++) {
      try {
        task(i);
      } catch (...) {
        const std::lock_guard<std::mutex> lock(mutex);
        if (i < failed) {
          failed = i;
          failure = std::current_exception();
        }
      }
    }
  };
  {
    std::vector<std::jthread> others;
    for (std::size_t k = 1; k < workers; ++k) others.emplace_back(work);
    work();
  }
  if (failure) std::rethrow_exception(failure);
}

void parallel_ranges(int threads, std::size_t size, std::size_t grain,
                     const std::function<void(std::size_t first, std::size_t last)>& body) {
  const std::size_t step = std::max<std::size_t>(grain, 1);
  parallel_for(threads, (size + step - 1) / step,
               [&](std::size_t i) { body(i * step, std::min(size, (i + 1) * step)); });
}

}  // namespace delfront
