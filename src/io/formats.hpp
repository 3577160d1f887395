// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/io.hpp"
#include "delfront/mesh.hpp"

namespace delfront {

class Output;

// Every reader takes the bytes of a whole file; `path` is for messages only. Memory stays proportional to the bytes,
// whatever counts they claim. All throw InputError (what, line or byte, what to try) and check the context's limits.
// Every writer writes the whole file to `out` and adds a sentence to `notes` for each thing the format cannot hold.
// To add a format: its own read_<format>.cpp / write_<format>.cpp, two lines here and one in registry.cpp.

using Reader = Mesh (*)(std::string_view bytes, const std::string& path, Context& context);
using Writer = void (*)(const Mesh& mesh, Output& out, const WriteOptions& options, Context& context,
                        std::vector<std::string>& notes);

Mesh read_stl(std::string_view bytes, const std::string& path, Context& context);
Mesh read_obj(std::string_view bytes, const std::string& path, Context& context);
Mesh read_ply(std::string_view bytes, const std::string& path, Context& context);
Mesh read_off(std::string_view bytes, const std::string& path, Context& context);
Mesh read_poly(std::string_view bytes, const std::string& path, Context& context);
/// @brief Triangle's .poly in the plane; read_poly hands such files on.
Mesh read_planar_poly(std::string_view bytes, const std::string& path, Context& context);
Mesh read_dat(std::string_view bytes, const std::string& path, Context& context);
Mesh read_vtu(std::string_view bytes, const std::string& path, Context& context);
Mesh read_vtp(std::string_view bytes, const std::string& path, Context& context);
Mesh read_msh(std::string_view bytes, const std::string& path, Context& context);
Mesh read_medit(std::string_view bytes, const std::string& path, Context& context);
Mesh read_meshb(std::string_view bytes, const std::string& path, Context& context);
Mesh read_su2(std::string_view bytes, const std::string& path, Context& context);
Mesh read_pos(std::string_view bytes, const std::string& path, Context& context);
Mesh read_nastran(std::string_view bytes, const std::string& path, Context& context);
Mesh read_abaqus(std::string_view bytes, const std::string& path, Context& context);
Mesh read_fluent(std::string_view bytes, const std::string& path, Context& context);
Mesh read_ugrid(std::string_view bytes, const std::string& path, Context& context);
/// @brief Files that are netCDF-4 are opened a second time, by `path`.
Mesh read_exodus(std::string_view bytes, const std::string& path, Context& context);

/// @brief FUN3D's .mapbc beside a UGRID: names and kinds of its surfaces, names of its volumes.
void read_mapbc(std::string_view bytes, const std::string& path, Mesh& mesh, Context& context);
void write_mapbc(const Mesh& mesh, Output& out, std::vector<std::string>& notes);

/// @brief Add the fields of a Medit solution to its mesh; a warning where the number of nodes is another.
void read_sol(std::string_view bytes, const std::string& path, Mesh& mesh, Context& context);
void read_solb(std::string_view bytes, const std::string& path, Mesh& mesh, Context& context);

void write_stl(const Mesh&, Output&, const WriteOptions&, Context&, std::vector<std::string>& notes);
void write_obj(const Mesh&, Output&, const WriteOptions&, Context&, std::vector<std::string>& notes);
void write_ply(const Mesh&, Output&, const WriteOptions&, Context&, std::vector<std::string>& notes);
void write_off(const Mesh&, Output&, const WriteOptions&, Context&, std::vector<std::string>& notes);
void write_vtu(const Mesh&, Output&, const WriteOptions&, Context&, std::vector<std::string>& notes);
void write_vtp(const Mesh&, Output&, const WriteOptions&, Context&, std::vector<std::string>& notes);
void write_msh(const Mesh&, Output&, const WriteOptions&, Context&, std::vector<std::string>& notes);
void write_medit(const Mesh&, Output&, const WriteOptions&, Context&, std::vector<std::string>& notes);
void write_meshb(const Mesh&, Output&, const WriteOptions&, Context&, std::vector<std::string>& notes);
void write_su2(const Mesh&, Output&, const WriteOptions&, Context&, std::vector<std::string>& notes);
void write_nastran(const Mesh&, Output&, const WriteOptions&, Context&, std::vector<std::string>& notes);
void write_abaqus(const Mesh&, Output&, const WriteOptions&, Context&, std::vector<std::string>& notes);
void write_fluent(const Mesh&, Output&, const WriteOptions&, Context&, std::vector<std::string>& notes);
void write_ugrid(const Mesh&, Output&, const WriteOptions&, Context&, std::vector<std::string>& notes);
void write_ugrid_b8(const Mesh&, Output&, const WriteOptions&, Context&, std::vector<std::string>& notes);
void write_ugrid_lb8(const Mesh&, Output&, const WriteOptions&, Context&, std::vector<std::string>& notes);
void write_sol(const Mesh&, Output&, const WriteOptions&, Context&, std::vector<std::string>& notes);
void write_solb(const Mesh&, Output&, const WriteOptions&, Context&, std::vector<std::string>& notes);
void write_exodus(const Mesh&, Output&, const WriteOptions&, Context&, std::vector<std::string>& notes);

/// @brief CGNS, where its library was there when this was built. Its files are read and written by name.
Mesh read_cgns(const std::string& path, Context& context);
/// @param shown_path  for messages; `path` is the temporary file
void write_cgns(const Mesh& mesh, const std::string& path, const std::string& shown_path, const WriteOptions& options,
                Context& context, std::vector<std::string>& notes);

/// @brief Formats in HDF5, where it was there when this was built; all but XDMF's XML by name too.
Mesh read_xdmf(std::string_view bytes, const std::string& path, Context& context);
void write_xdmf(const Mesh& mesh, const std::string& path, const std::string& shown_path, const WriteOptions& options,
                Context& context, std::vector<std::string>& notes);
Mesh read_vtkhdf(const std::string& path, Context& context);
void write_vtkhdf(const Mesh& mesh, const std::string& path, const std::string& shown_path, const WriteOptions& options,
                  Context& context, std::vector<std::string>& notes);

/// @brief The files of a polyMesh; the zones may be empty.
struct FoamFiles {
  std::string_view points, faces, owner, neighbour, boundary, cell_zones, face_zones;
};

/// @brief Read these files, ASCII as write_openfoam makes them.
/// @param path  of their folder, for messages
Mesh read_foam_files(const FoamFiles& files, const std::string& path, Context& context);

/// @brief Read an OpenFOAM case, or its polyMesh folder.
Mesh read_openfoam(const std::string& path, Context& context);

/// @brief Write an OpenFOAM case: `folder`/constant/polyMesh, and a minimal system/ where the case has none.
void write_openfoam(const Mesh& mesh, const std::string& folder, Context& context, std::vector<std::string>& notes);

}  // namespace delfront
