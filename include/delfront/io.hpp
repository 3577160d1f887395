// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/findings.hpp"
#include "delfront/mesh.hpp"

namespace delfront {

struct WriteOptions {
  bool binary = true;     ///< where the format has both
  std::string version;    ///< MSH: "2.2" or "4.1" (default 4.1)
  bool compress = false;  ///< VTK XML, VTKHDF, XDMF: zlib
};

/// @brief A file format: what it is called, how it is recognised, what it can do.
struct FormatInfo {
  std::string name;                     ///< "stl", "vtu", "msh", "medit", "su2", "openfoam", …
  std::string title;                    ///< "STL (ASCII and binary)"
  std::vector<std::string> extensions;  ///< lower case, with the dot; "/" for an OpenFOAM case
  bool can_read = false, can_write = false;
};

/// @brief All formats, in the order they are listed to a user.
const std::vector<FormatInfo>& formats();

/// @brief The format that read_mesh (or, with `to_write`, write_mesh) takes for this path and `format`.
/// @throws UsageError  unknown, or it cannot be read (written): lists those that can, with the nearest name
const FormatInfo& format_of(const std::string& path, const std::string& format = "", bool to_write = false);

/// @brief Read a file; the type comes from the extension unless `format` names one. A folder is an OpenFOAM case.
///
/// STL and other facet files come as triangles (polygons kept) with one group of dimension 2 a solid or named group;
/// points as they stand in the file, not welded (STL: three a facet). Node fields come along from VTK files, MSH
/// ($NodeData, $ElementNodeData), .pos views and Medit solutions (.sol beside the .mesh); symmetric tensors have the
/// order xx yy zz xy yz xz, in the plane xx xy yy.
/// @throws InputError  missing, empty, truncated, malformed (what, where: line or byte, what to try)
Mesh read_mesh(const std::string& path, Context& context, const std::string& format = "");

/// @brief True where read_mesh hands the file to a library that its bytes may crash when it is damaged (HDF5, CGNS).
bool is_read_by_library(const std::string& path, const std::string& format = "");

/// @brief What Context::on_log hears (debug, each followed by the path) before and after such a library is at work:
/// whoever guards against a crash knows by these what it was at.
inline constexpr const char* kLibraryReadingBegins = "HDF5 reads ";
inline constexpr const char* kLibraryReadingEnds = "HDF5 has read ";

/// @brief Write a file under a temporary name beside it, then rename it; a name ending in '/' is an OpenFOAM case.
/// @return names that the format could not hold and how they were changed, as sentences
/// @throws IoError     cannot write (the temporary file is removed)
/// @throws InputError  the format cannot hold this mesh (what it lacks)
std::vector<std::string> write_mesh(const Mesh& mesh, const std::string& path, Context& context,
                                    const WriteOptions& options = {}, const std::string& format = "");

/// @brief Solvers that write_starter_files knows, each by the name of the format it reads: su2, openfoam.
const std::vector<std::string>& starter_solvers();

/// @brief What write_starter_files did.
struct StarterFiles {
  std::vector<std::string> written, kept;  ///< paths; kept: they were there before, and nothing was changed in them
  std::vector<std::string> notes;          ///< sentences: what was taken for granted, what kept files do not name
};

/// @brief Files with which a solver starts on the grid that stands at `path`, each naming every boundary as it does.
///
/// SU2: NAME.cfg beside NAME.su2. OpenFOAM: 0/, constant/ and system/ for potentialFoam and simpleFoam. The condition
/// of a boundary follows from its kind; one whose kind says none (none given, patch, cyclic, interface) is a wall,
/// with a comment there. All values are in SI: coordinates are metres. A file that exists is never changed, except a
/// file in system/ that is still as write_mesh made it.
/// @param mesh  as it was written to `path`
/// @throws UsageError  another solver, or `path` holds no grid for this one
/// @throws InputError  no such grid at `path`
/// @throws IoError     cannot write; files written before stay, each whole
StarterFiles write_starter_files(const Mesh& mesh, const std::string& path, const std::string& solver, Context& context,
                                 const std::string& format = "");

/// @brief Throws IoError now, not after an hour, where `path` cannot be written later. Leaves nothing behind.
void check_writable(const std::string& path);

/// @brief Findings as a VTP: places as vertices, edges as lines, faces as polygons, with their kind, severity and ids.
void write_defects(const std::vector<Finding>& findings, const std::string& path, Context& context);

}  // namespace delfront
