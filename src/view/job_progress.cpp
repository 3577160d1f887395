// SPDX-License-Identifier: Apache-2.0
#include "view/job_progress.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <utility>

namespace delfront {

namespace {
using Json = nlohmann::ordered_json;
constexpr std::size_t kMostMessages = 100, kLongestLine = 1 << 20, kMostAtOnce = 1 << 24;
}  // namespace

JobProgress::JobProgress(std::string path) : path_(std::move(path)) {
  if (path_ == "-") file_ = STDIN_FILENO;
}

JobProgress::~JobProgress() {
  if (file_ > STDIN_FILENO) close(file_);
}

bool JobProgress::is_readable() const {
  pollfd waiting = {file_, POLLIN, 0};
  return poll(&waiting, 1, 0) > 0;
}

void JobProgress::update() {
  if (has_ended_) return;
  if (file_ < 0) file_ = open(path_.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  char buffer[65536];
  for (std::size_t taken = 0; file_ >= 0 && taken < kMostAtOnce && is_readable();) {
    const ssize_t size = read(file_, buffer, sizeof buffer);
    if (size == 0 && path_ == "-") has_ended_ = true;
    if (size <= 0) break;
    taken += static_cast<std::size_t>(size);
    rest_.append(buffer, static_cast<std::size_t>(size));
    std::size_t begin = 0;
    for (std::size_t end; (end = rest_.find('\n', begin)) != std::string::npos; begin = end + 1)
      take_line(rest_.substr(begin, end - begin));
    rest_.erase(0, begin);
    if (rest_.size() > kLongestLine) rest_.clear();
  }
}

void JobProgress::take_line(const std::string& line) {
  Json event = Json::parse(line, nullptr, false);
  if (!event.is_object() || !event.contains("event") || !event["event"].is_string()) return;  // of another program
  has_begun_ = true;
  const std::string what = event["event"];
  if (what == "progress" && event.contains("stage")) {
    for (Json& stage : stages_)
      if (stage["stage"] == event["stage"]) {
        stage = std::move(event);
        return;
      }
    stages_.push_back(std::move(event));
  } else if (what == "error") {
    error_ = std::move(event);
    has_ended_ = true;
  } else if (messages_.size() < kMostMessages && event.contains("message")) {
    messages_.push_back(std::move(event));
  }
}

Json JobProgress::state() const {
  return {{"stages", stages_},
          {"messages", messages_},
          {"error", error_},
          {"has_begun", has_begun_},
          {"has_ended", has_ended_}};
}

}  // namespace delfront
