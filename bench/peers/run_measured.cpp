// SPDX-License-Identifier: Apache-2.0
// Runs one command and writes what it cost, for bench/compare_peers.py.
//
//   run_measured RESULT.json LIMIT_SECONDS COMMAND...
//
// A child's peak memory as Linux counts it starts with that of the process it was forked from. So the benchmark, whose
// own memory is large, starts this small program, and only this one starts the tool: its floor is 2 MB. The command
// runs in a process group of its own, all of which is ended when the limit passes.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>

namespace {

volatile pid_t group = 0;
volatile std::sig_atomic_t stopped = 0;

extern "C" void stop_group(int) {
  stopped = 1;
  kill(-group, SIGKILL);
}

double seconds_of(const timeval& time) { return static_cast<double>(time.tv_sec) + 1e-6 * time.tv_usec; }

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return std::fprintf(stderr, "usage: run_measured RESULT.json LIMIT_SECONDS COMMAND...\n"), 2;
  const auto start = std::chrono::steady_clock::now();
  const pid_t child = fork();
  if (child == 0) {
    setpgid(0, 0);
    execvp(argv[3], argv + 3);
    std::perror(argv[3]);
    _exit(127);
  }
  setpgid(child, child);
  group = child;
  for (const int signal_number : {SIGALRM, SIGTERM, SIGINT}) std::signal(signal_number, stop_group);
  alarm(static_cast<unsigned>(std::atoi(argv[2])));
  int status = 0;
  rusage usage = {};
  while (wait4(child, &status, 0, &usage) < 0) {
  }
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::FILE* file = std::fopen(argv[1], "w");
  if (!file) return std::perror(argv[1]), 1;
  std::fprintf(file,
               "{\"whole\": %.6f, \"user\": %.6f, \"system\": %.6f, \"rss\": %ld, \"status\": %d, \"stopped\": %s}\n",
               wall, seconds_of(usage.ru_utime), seconds_of(usage.ru_stime), usage.ru_maxrss * 1024,
               WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status), stopped ? "true" : "false");
  return std::fclose(file) == 0 ? 0 : 1;
}
