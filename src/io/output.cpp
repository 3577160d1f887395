// SPDX-License-Identifier: Apache-2.0
#include "io/output.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>

#include "delfront/errors.hpp"

namespace delfront {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kBufferSize = std::size_t{1} << 20;
constexpr int kMaxTries = 10000;

std::string reason(int error) { return std::strerror(error); }

std::string folder_of(const std::string& path) {
  const fs::path parent = fs::path(path).parent_path();
  return parent.empty() ? "." : parent.string();
}

/// Says which part of the way to `folder` is wrong.
void check_folder(const std::string& path, const std::string& folder) {
  std::error_code error;
  const fs::file_status status = fs::status(folder, error);
  if (fs::is_directory(status)) {
    if (::access(folder.c_str(), W_OK | X_OK) != 0)
      throw IoError(
          fmt::format("cannot write {}: no permission to write in folder {} ({})", path, folder, reason(errno)));
    return;
  }
  fs::path part;
  for (const fs::path& piece : fs::path(folder)) {
    part /= piece;
    const fs::file_status here = fs::status(part, error);
    if (fs::exists(here) && !fs::is_directory(here))
      throw IoError(
          fmt::format("cannot write {}: {} is a file, not a folder; choose another output path", path, part.string()));
    if (!fs::exists(here))
      throw IoError(fmt::format("cannot write {}: folder {} does not exist ({}); make it first", path, part.string(),
                                error ? error.message() : reason(ENOENT)));
  }
  throw IoError(fmt::format("cannot write {}: {} is not a folder", path, folder));
}

bool is_device_or_pipe(const std::string& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

/// The file behind a chain of links, so that writing keeps the link.
std::string behind_links(const std::string& path) {
  std::error_code error;
  if (!fs::is_symlink(path, error)) return path;
  const fs::path real = fs::weakly_canonical(path, error);
  return error ? path : real.string();
}

std::string without_slash(std::string path) {
  while (path.size() > 1 && path.ends_with('/')) path.pop_back();
  return path;
}

}  // namespace

Output::Output(const std::string& path, std::string shown_path)
    : shown_path_(std::move(shown_path)), buffer_(new char[kBufferSize]) {
  file_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file_ < 0) fail("open", errno);
}

Output::~Output() {
  if (file_ >= 0) ::close(file_);
}

void Output::fail(const char* doing, int error) const {
  throw IoError(fmt::format("cannot {} {}: {}{}", doing, shown_path_, reason(error),
                            error == ENOSPC || error == EDQUOT ? "; free some space or choose another folder" : ""));
}

void Output::write_out(const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t written = ::write(file_, data, size);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("write", errno);
    data += written;
    size -= static_cast<std::size_t>(written);
  }
}

void Output::flush() {
  write_out(buffer_.get(), used_);
  used_ = 0;
}

char* Output::reserve(std::size_t size) {
  if (used_ + size > kBufferSize) flush();
  return buffer_.get() + used_;
}

void Output::bytes(const void* data, std::size_t size) {
  if (size == 0) return;
  if (size >= kBufferSize) {
    flush();
    write_out(static_cast<const char*>(data), size);
    return;
  }
  std::memcpy(reserve(size), data, size);
  used_ += size;
}

void Output::integer(std::int64_t value) {
  char* begin = reserve(24);
  used_ += static_cast<std::size_t>(std::to_chars(begin, begin + 24, value).ptr - begin);
}

void Output::real(double value) {
  char* begin = reserve(32);
  used_ += static_cast<std::size_t>(std::to_chars(begin, begin + 32, value).ptr - begin);
}

void Output::close() {
  flush();
  const int file = file_;
  file_ = -1;
  if (::close(file) != 0) fail("write", errno);
}

Replacement::Replacement(const std::string& path, Of what)
    : shown_path_(path), target_(behind_links(without_slash(path))), what_(what) {
  if (what == Of::folder) {
    make_folder();
  } else if (is_device_or_pipe(target_)) {
    temporary_ = target_;
  } else {
    make_file();
  }
}

void Replacement::make_file() {
  check_file_place(target_);
  const std::string folder = folder_of(target_);
  for (int i = 0; i < kMaxTries; ++i) {
    temporary_ = fmt::format("{}/.delfront-{}-{}.tmp", folder, ::getpid(), i);
    const int file = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file >= 0) {
      ::close(file);
      is_pending_ = true;
      return;
    }
    if (errno != EEXIST) break;
  }
  throw IoError(
      fmt::format("cannot write {}: no temporary file can be made beside it: {}", shown_path_, reason(errno)));
}

void Replacement::make_folder() {
  const std::string folder = folder_of(target_);
  check_folder(shown_path_, folder);
  for (int i = 0; i < kMaxTries; ++i) {
    temporary_ = fmt::format("{}/.delfront-{}-{}.tmp", folder, ::getpid(), i);
    if (::mkdir(temporary_.c_str(), 0777) == 0) {
      is_pending_ = true;
      return;
    }
    if (errno != EEXIST) break;
  }
  throw IoError(
      fmt::format("cannot write {}: no temporary folder can be made beside it: {}", shown_path_, reason(errno)));
}

void Replacement::commit() {
  if (!is_pending_) return;
  std::error_code error;
  std::string old;
  if (what_ == Of::folder && fs::exists(target_, error)) {  // a folder cannot be renamed onto one that is not empty
    old = temporary_ + ".old";
    fs::rename(target_, old, error);
    if (error) throw IoError(fmt::format("cannot replace {}: {}", shown_path_, error.message()));
  }
  fs::rename(temporary_, target_, error);
  if (error) {
    std::error_code ignored;
    if (!old.empty()) fs::rename(old, target_, ignored);
    throw IoError(fmt::format("cannot write {}: {}", shown_path_, error.message()));
  }
  is_pending_ = false;
  if (!old.empty()) fs::remove_all(old, error);
}

Replacement::~Replacement() {
  std::error_code ignored;
  if (is_pending_) fs::remove_all(temporary_, ignored);
}

void check_file_place(const std::string& path) {
  if (path.empty()) throw IoError("cannot write: the output path is empty");
  if (is_device_or_pipe(path)) return;
  const std::string target = behind_links(path);
  std::error_code error;
  if (fs::is_directory(target, error))
    throw IoError(fmt::format("cannot write {}: it is a folder; name a file in it", path));
  check_folder(path, folder_of(target));
  const std::string name = fs::path(target).filename().string();
  if (name.size() > 255) throw IoError(fmt::format("cannot write {}: {}", path, reason(ENAMETOOLONG)));
}

void check_folder_place(const std::string& path) {
  const std::string folder = without_slash(path);
  std::error_code error;
  const fs::file_status status = fs::status(folder, error);
  if (fs::is_directory(status)) {
    const std::string constant = folder + "/constant";
    check_folder(path, fs::exists(constant, error) ? constant : folder);
    return;
  }
  if (fs::exists(status))
    throw IoError(fmt::format("cannot write {}: {} is a file, not a folder; choose another output path", path, folder));
  check_folder(path, folder_of(folder));
}

}  // namespace delfront
