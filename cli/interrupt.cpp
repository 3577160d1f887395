// SPDX-License-Identifier: Apache-2.0
#include "interrupt.hpp"

#include <unistd.h>

#include <csignal>

namespace delfront::cli {

// A signal handler can reach nothing but what stands still: these variables are global.
static std::atomic<bool> own_token{false}, was_interrupted{false};
static std::atomic<std::atomic<bool>*> token{&own_token};
static std::atomic<pid_t> child_to_end{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<std::atomic<bool>*>::is_always_lock_free);

static void on_signal(int) {
  const bool is_second = was_interrupted.exchange(true);
  token.load()->store(true);
  if (!is_second) return;
  if (child_to_end == 0) _exit(130);
  kill(child_to_end, SIGKILL);
}

std::atomic<bool>* stop_on_interrupt() {
  struct sigaction action = {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
  struct sigaction before = {};
  sigaction(SIGHUP, nullptr, &before);
  if (before.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);  // nohup asked to go on after a hang-up
  return token;
}

void share_interrupt(std::atomic<bool>* shared, pid_t child) {
  token = shared;
  child_to_end = child;
}

}  // namespace delfront::cli
