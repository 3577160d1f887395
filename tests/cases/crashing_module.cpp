// SPDX-License-Identifier: Apache-2.0
// Stands in for the module of CAD files, and does what the file says, as its first word: crash, abort, hang, kill,
// wait.
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>

#include "cad/cad_data.hpp"

namespace delfront::cad {
namespace {

Result* read(const Request* request) {
  std::string word;
  std::ifstream(request->path) >> word;
  if (request->progress) request->progress(request->user, "reading", 0.5);
  if (word == "crash") raise(SIGSEGV);
  if (word == "abort") std::abort();
  if (word == "kill") raise(SIGKILL);
  auto* const result = new Result;
  result->error = "made to fail";
  using std::chrono::milliseconds;
  if (word == "hang" || word == "wait") std::ofstream(std::string(request->path) + ".at_work") << word;
  while (word == "hang") std::this_thread::sleep_for(milliseconds(10));
  while (word == "wait") {
    std::this_thread::sleep_for(milliseconds(10));
    if (request->progress(request->user, "waiting", -1)) continue;
    result->ending = Result::Ending::stopped;
    break;
  }
  return result;
}

void release(Result* result) { delete result; }

constexpr ModuleInfo kInfo{
    kInterfaceVersion, sizeof(Request), sizeof(Result), sizeof(Face), "a module that crashes", read, release};

}  // namespace
}  // namespace delfront::cad

extern "C" __attribute__((visibility("default"))) const delfront::cad::ModuleInfo* delfront_cad_module() {
  return &delfront::cad::kInfo;
}
