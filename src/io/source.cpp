// SPDX-License-Identifier: Apache-2.0
#include "io/source.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "delfront/errors.hpp"

namespace delfront {

namespace {

constexpr std::size_t kFirstGuess = std::size_t{1} << 16;  // for pipes, whose size nobody knows

class Descriptor {
 public:
  explicit Descriptor(const std::string& path) : file_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {}
  ~Descriptor() {
    if (file_ >= 0) ::close(file_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return file_; }

 private:
  int file_;
};

}  // namespace

FileBytes::FileBytes(const std::string& path) {
  const Descriptor file(path);
  struct stat facts {};
  if (file.get() < 0 || ::fstat(file.get(), &facts) != 0)
    throw InputError(fmt::format("cannot read {}: {}", path, std::strerror(errno)));
  if (S_ISDIR(facts.st_mode)) throw InputError(fmt::format("cannot read {}: it is a folder, not a file", path));
  // One byte more than the size, so that the end shows without growing.
  std::size_t room = S_ISREG(facts.st_mode) ? static_cast<std::size_t>(facts.st_size) + 1 : kFirstGuess;
  data_.reset(new char[room]);
  for (;;) {
    const ssize_t got = ::read(file.get(), data_.get() + size_, room - size_);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw InputError(fmt::format("cannot read {}: {}", path, std::strerror(errno)));
    if (got == 0) break;
    size_ += static_cast<std::size_t>(got);
    if (size_ < room) continue;
    std::unique_ptr<char[]> larger(new char[room * 2]);
    std::memcpy(larger.get(), data_.get(), size_);
    data_ = std::move(larger);
    room *= 2;
  }
  if (size_ == 0) throw InputError(fmt::format("{}: the file is empty; export it again", path));
}

}  // namespace delfront
