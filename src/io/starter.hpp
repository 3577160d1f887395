// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "delfront/io.hpp"
#include "delfront/mesh.hpp"

namespace delfront {

/// @brief A boundary as a solver's grid file has it.
struct StarterBoundary {
  std::string name;                 ///< as in that file
  std::string kind;                 ///< boundary kind; empty: none is known
  std::string patch_type;           ///< OpenFOAM: its type in constant/polyMesh/boundary
  Point inward = {1, 0, 0};         ///< mean direction into the grid, where the kind is "inlet"
  bool is_wall_by_default = false;  ///< its kind says no condition (none, patch, cyclic, interface)
};

/// @brief One file of a starter, and the boundaries it must name.
struct StarterFile {
  std::string path, text;
  bool names_boundaries = false;
  std::string replaceable;  ///< a file with exactly this text is not the user's
};

/// @brief What all starters assume of the flow; SI.
namespace starter {
inline constexpr double kSpeed = 10;           // m/s
inline constexpr double kViscosity = 1.5e-5;   // m^2/s, air
inline constexpr double kIntensity = 0.01;     // of turbulence: rms over speed
inline constexpr double kViscosityRatio = 10;  // eddy over molecular
}  // namespace starter

/// @brief The mean direction into the grid of the faces (in the plane: lines) of a group, to six digits.
///
/// Their orientation is not relied on, as files may have turned it: each face's cell tells where the grid is.
/// @return {1, 0, 0} where they have no mean direction, as on a whole sphere
/// @par Cost  one look at each cell
Point inward_direction(const Mesh& mesh, GroupId group);

/// @brief "  % note" or "  // note" on a boundary that is a wall because nothing else is known; "" on others.
std::string wall_note(const StarterBoundary& boundary, const char* comment);

/// @brief The markers of the .su2 file that write_su2 makes of this mesh, in its order.
std::vector<StarterBoundary> su2_boundaries(const Mesh& mesh);

/// @brief The one file of SU2: `path` with the extension .cfg.
StarterFile su2_starter(const Mesh& mesh, const std::string& path, const std::vector<StarterBoundary>& boundaries);

/// @brief The patches of the case that stands in `folder`, with the kinds that the mesh's groups have.
/// @throws InputError  no polyMesh there
std::vector<StarterBoundary> foam_boundaries(const Mesh& mesh, const std::string& folder);

/// @brief The files of an OpenFOAM case but for its grid, in the order they are written.
std::vector<StarterFile> foam_starter(const std::string& folder, const std::vector<StarterBoundary>& boundaries);

}  // namespace delfront
