// SPDX-License-Identifier: Apache-2.0
// What becomes of a file, found out in a process of its own: it may crash, or go on for ever.
#pragma once
#include <string>

namespace delfront::fixtures {

struct Outcome {
  enum class Way {
    gridded,
    input_error,
    meshing_error,
    other_error,
    crashed_reading,  ///< in the library that reads CAD: what the command line's parent process is for
    crashed,          ///< in our own code
    endless,
  } way = Way::crashed;
  std::string message;  ///< of the error
  std::string notes;    ///< kinds of repairs and suspicious things, each once, with blanks round them
  std::size_t num_notes = 0, free_edges = 0, faces = 0;
  bool is_closed = false, has_place = false;
  double area = 0, volume = 0, seconds = 0;

  bool has(const std::string& kind) const { return notes.find(' ' + kind + ' ') != std::string::npos; }
};

/// @param seconds  until it counts as endless
/// @param grids  whether the surface is gridded, too (with sides of a twentieth of the diagonal)
Outcome find_outcome(const std::string& path, unsigned seconds = 60, bool grids = true);

std::string name_of(Outcome::Way way);

}  // namespace delfront::fixtures
