// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "delfront/errors.hpp"

namespace delfront {

enum class Severity : std::uint8_t {
  note,     ///< worth knowing: "2 components", "units: probably mm"
  warning,  ///< gridding works, the grid may suffer: slivers, thin spots
  error,    ///< cannot be gridded as it is
};

/// @brief What a viewer draws of a finding: an edge (two corners), or a face.
struct Outline {
  std::uint32_t id = 0;  ///< as in the places
  std::vector<Point> corners;
};

/// @brief One kind of thing found in a surface or a grid: how many, which, where, what to try.
struct Finding {
  std::string kind;  ///< stable key, e.g. "open_edges", "self_intersection", "duplicate_triangles", "flat_cell"
  Severity severity = Severity::note;
  std::size_t count = 0;
  std::string message;                 ///< a sentence with the count and the first place
  std::string remedy;                  ///< what to try; may be empty
  std::vector<Place> places;           ///< the first of them (at most kMaxPlaces), each with ids
  std::vector<Outline> outlines = {};  ///< of the edges and faces it is about (at most kMaxOutlines)
};
inline constexpr std::size_t kMaxPlaces = 1000;
inline constexpr std::size_t kMaxOutlines = 100000;

inline bool has_errors(const std::vector<Finding>& findings) {
  for (const Finding& f : findings)
    if (f.severity == Severity::error) return true;
  return false;
}

}  // namespace delfront
