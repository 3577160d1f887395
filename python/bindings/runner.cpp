// SPDX-License-Identifier: Apache-2.0
#include "runner.hpp"

#include <nanobind/stl/string.h>

#include <algorithm>
#include <chrono>
#include <thread>

namespace delfront::python {

using namespace nb::literals;

static const char* name_of(LogLevel level) {
  return level == LogLevel::warning ? "warning" : level == LogLevel::info ? "info" : "debug";
}

void Runner::run(const std::function<void(Context&)>& work) {
  std::exception_ptr thrown;
  {
    const nb::gil_scoped_release released;
    std::thread worker([&] {
      try {
        Context context;
        set_up(context);
        work(context);
      } catch (...) {
        thrown = std::current_exception();
      }
      const std::lock_guard lock(mutex_);
      is_done_ = true;
      woken_.notify_one();
    });
    while (!wait_for_end()) serve();
    worker.join();
    serve();  // what came at the end
  }
  if (failure_) std::rethrow_exception(failure_);
  if (thrown) std::rethrow_exception(thrown);
}

void Runner::stop_with(std::exception_ptr failure) {
  const std::lock_guard lock(mutex_);
  if (!failure_) failure_ = std::move(failure);
  cancel_ = true;
}

void Runner::set_up(Context& context) {
  const int all = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  context.threads = hooks_.threads > 0 ? hooks_.threads : all;
  context.cancel = &cancel_;
  if (!hooks_.progress.is_none())
    context.on_progress = [this](const Progress& progress) { put({true, progress, "", ""}); };
  if (!hooks_.log.is_none())
    context.on_log = [this](LogLevel level, const std::string& message) { put({false, {}, name_of(level), message}); };
}

/// The work does not wait for Python; what is out of date when Python comes to it is left out.
void Runner::put(Event event) {
  const std::lock_guard lock(mutex_);
  const bool replaces = event.is_progress && !events_.empty() && events_.back().is_progress &&
                        events_.back().progress.stage == event.progress.stage;
  if (replaces)
    events_.back() = std::move(event);
  else
    events_.push_back(std::move(event));
}

bool Runner::wait_for_end() {
  constexpr auto kPause = std::chrono::milliseconds(50);
  std::unique_lock lock(mutex_);
  return woken_.wait_for(lock, kPause, [this] { return is_done_; });
}

void Runner::serve() {
  std::vector<Event> events;
  {
    const std::lock_guard lock(mutex_);
    events.swap(events_);
    if (failure_) return;  // the work has been told to end
  }
  const nb::gil_scoped_acquire acquired;
  if (!acquired.is_valid()) {  // the interpreter is shutting down
    cancel_ = true;
    return;
  }
  try {
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
    for (const Event& event : events) deliver(event);
  } catch (...) {
    stop_with(std::current_exception());
  }
}

void Runner::deliver(const Event& event) {
  const Progress& p = event.progress;
  if (event.is_progress)
    hooks_.progress(p.stage, p.done, p.total, p.unit);
  else
    hooks_.log(event.level, text_of(event.message));
}

void add_runner(nb::module_& module) {
  nb::class_<Hooks>(module, "Hooks", "How a run is to be run: threads, and what hears of its progress and messages.")
      .def(
          "__init__",
          [](Hooks* self, int threads, nb::object progress, nb::object log) {
            if (threads < 0) throw UsageError("threads: expected 0 (all) or a number of threads");
            new (self) Hooks{threads, std::move(progress), std::move(log)};
          },
          "threads"_a = 0, "progress"_a = nb::none(), "log"_a = nb::none());
}

}  // namespace delfront::python
