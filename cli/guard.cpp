// SPDX-License-Identifier: Apache-2.0
// Two processes share a page: the child notes there what it reads, the parent that it was interrupted. A pipe that
// nobody writes to wakes the parent when the child has ended.
#include "guard.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <new>
#include <span>

#include "delfront/cad.hpp"
#include "delfront/io.hpp"
#include "interrupt.hpp"

namespace delfront::cli {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kLook = 200;         ///< milliseconds between two looks at the child
constexpr double kPatience = 5.0;  ///< seconds that a library gets to stop by itself

/// Lies in memory that both processes see.
struct Shared {
  std::atomic<bool> is_interrupted{false};
  std::atomic<bool> is_reading{false};  ///< a library is at work; the path below is whole
  std::atomic<double> time_limit{0};    ///< seconds, 0: none
  std::array<char, 4096> path{};
  std::array<char, 32> library{};  ///< which is at work
};
static_assert(std::atomic<double>::is_always_lock_free);

Shared* make_shared_page() {
  void* const page = mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  return page == MAP_FAILED ? nullptr : new (page) Shared;
}

/// Of this process; null where it has no parent that watches over it.
Shared*& shared_with_parent() {
  static Shared* page = nullptr;
  return page;
}

bool is_crash(int signal) {
  for (const int crash : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGSYS, SIGTRAP})
    if (signal == crash) return true;
  return false;
}

/// What the program that wrote the file may be asked for instead.
std::string other_formats(const std::string& path) {
  if (!is_cad_file(path)) return "VTU";
  std::string suffix = std::filesystem::path(path).extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  if (suffix == ".step" || suffix == ".stp") return "another kind of STEP (AP203, AP214, AP242), or as IGES";
  return "STEP";
}

class Parent {
 public:
  Parent(pid_t child, int pipe, Shared& shared, Terminal& terminal)
      : child_(child), pipe_(pipe), shared_(shared), terminal_(terminal) {}

  int run() {
    wait_for_end();
    int status = 0;
    while (waitpid(child_, &status, 0) < 0 && errno == EINTR) {
    }
    if (WIFEXITED(status)) return WEXITSTATUS(status);
    return ended_by(WTERMSIG(status));
  }

 private:
  enum class Why { itself, interrupted, time };

  /// The pipe's other end closes when the child ends, whatever way it does.
  void wait_for_end() {
    pollfd end = {pipe_, POLLIN, 0};
    while (poll(&end, 1, kLook) <= 0) look_after_child();
    close(pipe_);
  }

  /// Reading that does not come back when it is asked to is stopped from here.
  void look_after_child() {
    const Clock::time_point now = Clock::now();
    const bool is_interrupted = shared_.is_interrupted;
    if (!is_interrupted) interrupted_ = now;
    if (!shared_.is_reading) return;
    if (is_interrupted && seconds(interrupted_, now) > kPatience) return stop(Why::interrupted);
    const double limit = shared_.time_limit;
    if (limit > 0 && seconds(start_, now) > limit + kPatience) stop(Why::time);
  }

  static double seconds(Clock::time_point a, Clock::time_point b) {
    return std::chrono::duration<double>(b - a).count();
  }

  void stop(Why why) {
    why_ = why;
    kill(child_, SIGKILL);
  }

  std::string path() const { return {shared_.path.data(), strnlen(shared_.path.data(), shared_.path.size())}; }
  std::string library() const {
    return {shared_.library.data(), strnlen(shared_.library.data(), shared_.library.size())};
  }

  int fail(ExitCode code, const std::string& message) {
    terminal_.error(code, message, {});
    return static_cast<int>(code);
  }

  int ended_by(int signal) {
    terminal_.clear_bar_of_others();
    if (why_ == Why::interrupted || (signal == SIGKILL && shared_.is_interrupted))
      return fail(ExitCode::interrupted, Cancelled().what());
    if (why_ == Why::time)
      return fail(
          ExitCode::limit_reached,
          fmt::format("stopped: the time limit of {:g} s is reached while {} was being read; it may be damaged: "
                      "export it again, or allow more time (--time-limit)",
                      shared_.time_limit.load(), path()));
    if (shared_.is_reading && is_crash(signal))
      return fail(ExitCode::bad_input,
                  fmt::format("{0} crashed while reading {1} ({2}); the file is damaged, or holds what "
                              "{0} cannot take; export it again, or as {3}, or part by part; nothing was written",
                              library(), path(), strsignal(signal), other_formats(path())));
    if (shared_.is_reading && signal == SIGKILL)
      return fail(ExitCode::limit_reached,
                  fmt::format("killed while reading {}, probably for the memory that took; the file may be damaged; "
                              "export it again, or part by part; nothing was written",
                              path()));
    return die_of(signal);
  }

  /// As if the parent itself had met it; the child's memory image is the one to look at.
  static int die_of(int signal) {
    const rlimit none = {0, 0};
    setrlimit(RLIMIT_CORE, &none);
    std::signal(signal, SIG_DFL);
    raise(signal);
    return 128 + signal;
  }

  pid_t child_;
  int pipe_;
  Shared& shared_;
  Terminal& terminal_;
  Clock::time_point start_ = Clock::now(), interrupted_ = start_;
  Why why_ = Why::itself;
};

void become_child(pid_t parent, const std::array<int, 2>& pipe, Shared* shared) {
  close(pipe[0]);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(static_cast<int>(ExitCode::interrupted));  // it died before that could be said
  shared_with_parent() = shared;
  share_interrupt(&shared->is_interrupted);
  stop_on_interrupt();
}

/// Signals wait while there are two processes and neither has said yet what is to become of them.
class Quiet {
 public:
  Quiet() {
    sigset_t all;
    sigfillset(&all);
    sigprocmask(SIG_BLOCK, &all, &before_);
  }
  ~Quiet() { sigprocmask(SIG_SETMASK, &before_, nullptr); }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;

 private:
  sigset_t before_{};
};

/// @return the child in the parent, 0 in the child, below 0: there is none
pid_t divide(const std::array<int, 2>& pipe, Shared* shared) {
  const Quiet quiet;
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child == 0) become_child(parent, pipe, shared);
  if (child <= 0) return child;
  share_interrupt(&shared->is_interrupted, child);
  stop_on_interrupt();
  return child;
}

void copy_text(const std::string& text, std::span<char> to) {
  const std::size_t length = std::min(text.size(), to.size() - 1);
  std::copy_n(text.begin(), length, to.begin());
  to[length] = '\0';
}

void note_reading(const char* library, const std::string& path, double time_limit, Shared& shared) {
  copy_text(path, shared.path);
  copy_text(library, shared.library);
  shared.time_limit = time_limit;
  shared.is_reading = true;
}

/// What the log says where a library begins and ends, and what a user is told of it.
struct LibraryWords {
  const char *begins, *ends, *name;
};
constexpr LibraryWords kLibraries[] = {{kCadReadingBegins, kCadReadingEnds, "OpenCASCADE"},
                                       {kLibraryReadingBegins, kLibraryReadingEnds, "HDF5"}};

}  // namespace

std::optional<int> go_on_in_child(Terminal& terminal) {
  Shared* const shared = make_shared_page();
  std::array<int, 2> ends{};
  if (!shared || pipe2(ends.data(), O_CLOEXEC) != 0) return std::nullopt;
  std::fflush(nullptr);  // what waits in buffers is to be written once
  const pid_t child = divide(ends, shared);
  if (child == 0) return std::nullopt;
  close(ends[1]);
  if (child < 0) {
    close(ends[0]);
    return std::nullopt;
  }
  return Parent(child, ends[0], *shared, terminal).run();
}

bool needs_guard(const std::string& path, const std::string& format) {
  return is_cad_file(path) || is_read_by_library(path, format);
}

void watch_reading(Context& context) {
  Shared* const shared = shared_with_parent();
  if (!shared) return;
  context.on_log = [shared, &context, hear = context.on_log](LogLevel level, const std::string& message) {
    for (const LibraryWords& words : kLibraries) {
      if (level != LogLevel::debug) break;
      if (message.starts_with(words.begins))
        note_reading(words.name, message.substr(std::strlen(words.begins)), context.time_limit, *shared);
      if (message.starts_with(words.ends)) shared->is_reading = false;
    }
    if (hear) hear(level, message);
  };
}

}  // namespace delfront::cli
