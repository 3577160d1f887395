// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "core.hpp"
#include "delfront/context.hpp"

namespace delfront::python {

/// @brief How a run is to be run: what every long function takes.
struct Hooks {
  int threads = 0;      ///< 0: all that the machine has
  nb::object progress;  ///< called with stage, done, total, unit; or None
  nb::object log;       ///< called with level ("debug", "info", "warning") and message; or None
};

/// @brief Runs work without Python's lock, so that other threads go on, and so that it can be stopped.
///
/// The work has a thread of its own. The thread that calls waits for it; a few times a second it takes the lock, lets
/// Python look for signals (in the main thread: Ctrl-C) and calls the hooks. What these raise stops the work and comes
/// out of run(), as does what functions raise that the work calls in threads of its own.
class Runner {
 public:
  explicit Runner(const Hooks& hooks) : hooks_(hooks) {}
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;

  /// @throws what was raised in Python, else what the work threw
  void run(const std::function<void(Context&)>& work);

  /// @brief From any thread: stop the work, and throw this from run() (the first one of several).
  void stop_with(std::exception_ptr failure);

 private:
  struct Event {
    bool is_progress = false;
    Progress progress;
    const char* level = "";
    std::string message;
  };

  void set_up(Context& context);
  void put(Event event);
  bool wait_for_end();
  void serve();
  void deliver(const Event& event);

  const Hooks& hooks_;
  std::atomic<bool> cancel_{false};
  std::mutex mutex_;
  std::condition_variable woken_;
  std::vector<Event> events_;   ///< of one stage only the last progress
  std::exception_ptr failure_;  ///< raised in Python
  bool is_done_ = false;
};

/// @brief The same for work that has a result.
template <class Work>
auto run_released(const Hooks& hooks, Work work) {
  decltype(work(std::declval<Context&>())) result;
  Runner runner(hooks);
  runner.run([&](Context& context) { result = work(context); });
  return result;
}

}  // namespace delfront::python
