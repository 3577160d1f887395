// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

#include "delfront/context.hpp"
#include "terminal.hpp"

namespace delfront::cli {

/// @brief True where go_on_in_child() is to be called before this file is read: CAD, HDF5, CGNS.
bool needs_guard(const std::string& path, const std::string& format = "");

/// @brief Go on in a child process, because a damaged file may crash or hang the library that reads it.
///
/// The parent only waits. It gives back the child's exit code, hands on signals, and says so where the child fell while
/// the library was at work (kCadReadingBegins, kLibraryReadingBegins); the child dies with its parent. Call it before
/// anything has threads. Where no process can be made the run goes on without.
/// @return in the child: nothing, go on; in the parent, after the child's end: the exit code
std::optional<int> go_on_in_child(Terminal& terminal);

/// @brief Let the parent know what a library reads, and how long that may take: listens to the context's log. Nothing
/// in a run without a parent.
void watch_reading(Context& context);

}  // namespace delfront::cli
