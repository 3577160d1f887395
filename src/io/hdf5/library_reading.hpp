// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "delfront/context.hpp"
#include "delfront/io.hpp"

namespace delfront {

/// @brief Lets the log know that HDF5 is at work on a file, as long as this is there.
class LibraryReading {
 public:
  LibraryReading(const std::string& path, Context& context) : path_(path), context_(context) {
    context_.log(LogLevel::debug, kLibraryReadingBegins + path_);
  }
  ~LibraryReading() {
    try {
      context_.log(LogLevel::debug, kLibraryReadingEnds + path_);
    } catch (...) {  // whoever listens may throw; what is under way matters more
    }
  }
  LibraryReading(const LibraryReading&) = delete;
  LibraryReading& operator=(const LibraryReading&) = delete;

 private:
  std::string path_;
  Context& context_;
};

}  // namespace delfront
