// SPDX-License-Identifier: Apache-2.0
// The one table of formats, and the public entries that look into it.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>

#include "base/nearest_name.hpp"
#include "base/plain_name.hpp"
#include "delfront/errors.hpp"
#include "delfront/io.hpp"
#include "io/formats.hpp"
#include "io/grid_files.hpp"
#include "io/output.hpp"
#include "io/source.hpp"

namespace delfront {

namespace {

/// A second file of the same stem that holds what the first cannot; without functions the format's own reader and
/// writer see to it.
struct Beside {
  const char* extension = nullptr;
  void (*read)(std::string_view bytes, const std::string& path, Mesh& mesh, Context& context) = nullptr;
  void (*write)(const Mesh& mesh, Output& out, std::vector<std::string>& notes) = nullptr;
};

struct Format {
  const char* name;
  const char* title;
  std::vector<std::string> extensions;
  Reader read;   // null: cannot
  Writer write;  // null: cannot, or a folder
  Beside beside = {};
  // Of libraries that open files themselves; then `read` and `write` are null.
  Mesh (*read_file)(const std::string& path, Context& context) = nullptr;
  void (*write_file)(const Mesh& mesh, const std::string& path, const std::string& shown_path,
                     const WriteOptions& options, Context& context, std::vector<std::string>& notes) = nullptr;
};

const Beside kMapbc = {".mapbc", read_mapbc, write_mapbc};

/// Gmsh and Fluent share an extension; only Fluent's files begin with a parenthesis.
Mesh read_any_msh(std::string_view bytes, const std::string& path, Context& context) {
  const std::size_t first = bytes.find_first_not_of(" \t\r\n");
  const bool is_fluent = first != std::string_view::npos && bytes[first] == '(';
  return is_fluent ? read_fluent(bytes, path, context) : read_msh(bytes, path, context);
}

constexpr const char* kFolderFormat = "openfoam";

const std::vector<Format>& table() {
  static const std::vector<Format> kTable = {
      {"stl", "STL (ASCII and binary)", {".stl", ".stla", ".stlb"}, read_stl, write_stl},
      {"obj", "Wavefront OBJ", {".obj"}, read_obj, write_obj},
      {"ply", "PLY (ASCII and binary)", {".ply"}, read_ply, write_ply},
      {"off", "OFF", {".off"}, read_off, write_off},
      {"poly", "TetGen facets, Triangle segments", {".poly"}, read_poly, nullptr},
      {"dat", "airfoil coordinates (Selig, Lednicer)", {".dat"}, read_dat, nullptr},
      {"vtu", "VTK XML unstructured grid", {".vtu"}, read_vtu, write_vtu},
      {"vtp", "VTK XML surface", {".vtp"}, read_vtp, write_vtp},
#ifdef DELFRONT_HAS_HDF5
      {"vtkhdf", "VTKHDF unstructured grid", {".vtkhdf", ".hdf"}, nullptr, nullptr, {}, read_vtkhdf, write_vtkhdf},
      {"xdmf", "XDMF, arrays in .h5", {".xdmf", ".xmf"}, read_xdmf, nullptr, {".h5"}, nullptr, write_xdmf},
#endif
      {"msh", "Gmsh MSH 2.2 and 4.1 (ASCII and binary)", {".msh"}, read_any_msh, write_msh},
      {"pos", "Gmsh parsed views (ASCII)", {".pos"}, read_pos, nullptr},
      {"medit", "Medit, MMG", {".mesh"}, read_medit, write_medit},
      {"meshb", "Medit, libMeshb (binary)", {".meshb"}, read_meshb, write_meshb},
      {"sol", "Medit solution: fields on points", {".sol"}, nullptr, write_sol},
      {"solb", "Medit solution (binary)", {".solb"}, nullptr, write_solb},
      {"su2", "SU2", {".su2"}, read_su2, write_su2},
#ifdef DELFRONT_HAS_CGNS
      {"cgns", "CGNS", {".cgns"}, nullptr, nullptr, {}, read_cgns, write_cgns},
#endif
      {"exodus", "Exodus II (netCDF)", {".e", ".exo", ".ex2", ".g"}, read_exodus, write_exodus},
      {"ugrid", "AFLR UGRID (ASCII), names in .mapbc", {".ugrid"}, read_ugrid, write_ugrid, kMapbc},
      {"ugrid-b8", "UGRID (binary, big endian)", {".b8.ugrid"}, read_ugrid, write_ugrid_b8, kMapbc},
      {"ugrid-lb8", "UGRID (binary, little endian)", {".lb8.ugrid"}, read_ugrid, write_ugrid_lb8, kMapbc},
      {"ugrid-other",
       "UGRID (single precision, 8-byte integers)",
       {".b4.ugrid", ".lb4.ugrid", ".b8l.ugrid", ".lb8l.ugrid"},
       read_ugrid,
       nullptr,
       kMapbc},
      {"fluent", "Ansys Fluent mesh; files .msh are told apart", {}, read_fluent, write_fluent},
      {"nastran", "Nastran bulk data", {".bdf", ".nas"}, read_nastran, write_nastran},
      {"abaqus", "Abaqus, CalculiX input", {".inp"}, read_abaqus, write_abaqus},
      {kFolderFormat, "OpenFOAM polyMesh in a case folder", {"/"}, nullptr, nullptr},
  };
  return kTable;
}

/// What this build leaves out, since a library was not installed.
struct LeftOut {
  const char* name;
  std::vector<std::string> extensions;
  const char* library;
};
const std::vector<LeftOut>& left_out_formats() {
  static const std::vector<LeftOut> kLeftOut = {
#ifndef DELFRONT_HAS_HDF5
      {"vtkhdf", {".vtkhdf", ".hdf"}, "HDF5 (Debian: libhdf5-dev)"},
      {"xdmf", {".xdmf", ".xmf"}, "HDF5 (Debian: libhdf5-dev)"},
#endif
#ifndef DELFRONT_HAS_CGNS
      {"cgns", {".cgns"}, "CGNS library (Debian: libcgns-dev)"},
#endif
  };
  return kLeftOut;
}

bool is_folder(const Format& format) { return std::string_view(format.name) == kFolderFormat; }
bool can_read(const Format& format) { return format.read || format.read_file || is_folder(format); }
bool can_write(const Format& format) { return format.write || format.write_file || is_folder(format); }

/// With the dot, lower case; ".b8.ugrid" where a format has that.
std::string extension_of(const std::string& path) {
  if (path.ends_with('/')) return "/";
  std::string name = std::filesystem::path(path).filename().string();
  for (char& c : name)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  for (const Format& format : table())
    for (const std::string& known : format.extensions)
      if (std::count(known.begin(), known.end(), '.') > 1 && name.ends_with(known) && name != known) return known;
  return std::filesystem::path(name).extension().string();
}

/// "wing.mapbc" for "wing.b8.ugrid".
std::string path_beside(const std::string& path, const char* extension) {
  const std::string own = extension_of(path);
  return path.substr(0, path.size() - own.size()) + extension;
}

/// Those that a path or a name may mean; none where it is unknown.
std::vector<const Format*> formats_meant(const std::string& path, const std::string& name) {
  std::vector<const Format*> meant;
  const std::string own = extension_of(path);
  for (const Format& known : table())
    if (name.empty() ? std::count(known.extensions.begin(), known.extensions.end(), own) > 0 : name == known.name)
      meant.push_back(&known);
  return meant;
}

/// ".stl .obj …" of the formats that can be read, or written.
std::vector<std::string> known_extensions(bool to_write) {
  std::vector<std::string> known;
  for (const Format& format : table())
    if (to_write ? can_write(format) : can_read(format))
      known.insert(known.end(), format.extensions.begin(), format.extensions.end());
  return known;
}

std::string hint(const std::string& wrong, const std::vector<std::string>& known) {
  const std::string nearest = nearest_name(wrong, known);
  return nearest.empty() ? "" : fmt::format("did you mean {}? ", nearest);
}

const Format& find_format(const std::string& path, const std::string& name, bool to_write) {
  const char* doing = to_write ? "written" : "read";
  std::error_code ignored;
  const bool is_case = !to_write && std::filesystem::is_directory(path, ignored);
  const std::string extension = is_case ? "/" : extension_of(path);
  for (const Format& format : table()) {
    const bool is_it = name.empty() ? std::find(format.extensions.begin(), format.extensions.end(), extension) !=
                                          format.extensions.end()
                                    : name == format.name;
    if (!is_it) continue;
    if (to_write ? can_write(format) : can_read(format)) return format;
    throw UsageError(fmt::format("{}: {} cannot be {}; these can: {}", path, format.title, doing,
                                 fmt::join(known_extensions(to_write), " ")));
  }
  for (const LeftOut& format : left_out_formats())
    if (name.empty()
            ? std::find(format.extensions.begin(), format.extensions.end(), extension) != format.extensions.end()
            : name == format.name)
      throw UsageError(fmt::format("{}: {} cannot be {}: this build has no {}; install it and build again, or use VTU",
                                   path, format.name, doing, format.library));
  if (!name.empty()) {
    std::vector<std::string> names;
    for (const Format& format : table()) names.push_back(format.name);
    throw UsageError(
        fmt::format("unknown format '{}': {}formats are {}", name, hint(name, names), fmt::join(names, " ")));
  }
  const std::vector<std::string> known = known_extensions(to_write);
  throw UsageError(fmt::format(
      "{}: {}; {}types that can be {}: {} (a name ending in / is an OpenFOAM case; or name one with --format)", path,
      extension.empty() ? "the name has no extension that says its type" : fmt::format("unknown type '{}'", extension),
      hint(extension, known), doing, fmt::join(known, " ")));
}

}  // namespace

const std::vector<FormatInfo>& formats() {
  static const std::vector<FormatInfo> kFormats = [] {
    std::vector<FormatInfo> all;
    for (const Format& format : table())
      all.push_back({format.name, format.title, format.extensions, can_read(format), can_write(format)});
    return all;
  }();
  return kFormats;
}

const FormatInfo& format_of(const std::string& path, const std::string& format, bool to_write) {
  const Format& found = find_format(path, format, to_write);
  return formats()[static_cast<std::size_t>(&found - table().data())];
}

bool is_read_by_library(const std::string& path, const std::string& format) {
  constexpr std::string_view kHdf5 = "\x89HDF";
  std::string_view name;
  try {
    name = find_format(path, format, false).name;
  } catch (const UsageError&) {  // whoever reads it will say so
    return false;
  }
  if (name == "cgns" || name == "vtkhdf" || name == "xdmf") return true;
  if (name != "exodus") return false;
  char first[4] = {};
  std::ifstream file(path, std::ios::binary);
  return file.read(first, sizeof(first)) && std::string_view(first, sizeof(first)) == kHdf5;
}

namespace {

/// A Medit solution of the same stem stands beside its mesh.
void read_solution_beside(const std::string& path, Mesh& mesh, Context& context) {
  for (const char* extension : {".sol", ".solb"}) {
    const std::string beside = std::filesystem::path(path).replace_extension(extension).string();
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(beside, ignored)) continue;
    const FileBytes bytes(beside);
    constexpr std::string_view kAscii = "MeshVersionFormatted";
    if (bytes.view().substr(0, 1000).find(kAscii) != std::string_view::npos || std::string_view(extension) == ".sol")
      return read_sol(bytes.view(), beside, mesh, context);
    return read_solb(bytes.view(), beside, mesh, context);
  }
}

void read_beside(const Beside& beside, const std::string& path, Mesh& mesh, Context& context) {
  if (!beside.read) return;
  const std::string second = path_beside(path, beside.extension);
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(second, ignored)) return;
  const FileBytes bytes(second);
  beside.read(bytes.view(), second, mesh, context);
}

void write_by_library(const Format& format, const Mesh& mesh, const std::string& path, Context& context,
                      const WriteOptions& options, std::vector<std::string>& notes) {
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored) &&
      !std::filesystem::is_directory(path, ignored))
    throw IoError(fmt::format("cannot write {}: {} goes to regular files only, and this is a device or a pipe", path,
                              format.title));
  Replacement replacement(path);
  format.write_file(mesh, replacement.temporary(), path, options, context, notes);
  replacement.commit();
}

/// A device or a pipe has nothing beside it.
bool may_have_beside(const std::string& path) {
  std::error_code ignored;
  return !std::filesystem::exists(path, ignored) || std::filesystem::is_regular_file(path, ignored);
}

/// Names that no terminal and few files can hold get other letters, and numbers where that makes two the same.
void plain_names(const std::string& path, Mesh& mesh, Context& context) {
  std::set<std::pair<int, std::string>> taken;
  std::size_t changed = 0;
  for (const Group& group : mesh.groups) taken.emplace(group.dimension, group.name);
  for (Group& group : mesh.groups) {
    const std::string plain = plain_name(group.name);
    if (plain == group.name) continue;
    std::string name = plain;
    for (int number = 2; !taken.emplace(group.dimension, name).second; ++number)
      name = fmt::format("{}_{}", plain, number);
    group.name = name;
    ++changed;
  }
  if (changed > 0) context.warn(say_plain_names(path, changed));
}

Mesh read_any(const std::string& path, Context& context, const std::string& format) {
  const Format& found = find_format(path, format, false);
  if (is_folder(found)) return read_openfoam(path, context);
  if (found.read_file) return found.read_file(path, context);
  const FileBytes bytes(path);
  context.check_limits();
  Mesh mesh = found.read(bytes.view(), path, context);
  if (found.read == read_medit || found.read == read_meshb) read_solution_beside(path, mesh, context);
  read_beside(found.beside, path, mesh, context);
  return mesh;
}

}  // namespace

Mesh read_mesh(const std::string& path, Context& context, const std::string& format) {
  Mesh mesh = read_any(path, context, format);
  plain_names(path, mesh, context);
  return mesh;
}

std::vector<std::string> write_mesh(const Mesh& mesh, const std::string& path, Context& context,
                                    const WriteOptions& options, const std::string& format) {
  const Format& found = find_format(path, format, true);
  if (found.beside.extension && path_beside(path, found.beside.extension) == path)
    throw UsageError(fmt::format("{}: as {} it has a second file beside it, of that very name; give it another ending",
                                 path, found.title));
  std::vector<std::string> notes;
  if (found.write_file) {
    write_by_library(found, mesh, path, context, options, notes);
    return notes;
  }
  if (!found.write) {
    write_openfoam(mesh, path, context, notes);
    return notes;
  }
  Replacement replacement(path);
  Output out(replacement.temporary(), path);
  found.write(mesh, out, options, context, notes);
  out.close();
  if (!found.beside.write || !may_have_beside(path)) {
    replacement.commit();
    return notes;
  }
  const std::string second = path_beside(path, found.beside.extension);
  Replacement replacement_beside(second);
  Output out_beside(replacement_beside.temporary(), second);
  found.beside.write(mesh, out_beside, notes);
  out_beside.close();
  replacement_beside.commit();
  replacement.commit();
  return notes;
}

std::vector<std::string> files_written_as(const std::string& path, const std::string& format) {
  std::vector<std::string> files = {path};
  for (const Format* known : formats_meant(path, format))
    if (can_write(*known) && known->beside.extension) files.push_back(path_beside(path, known->beside.extension));
  return files;
}

std::vector<std::string> files_read_as(const std::string& path, const std::string& format) {
  std::vector<std::string> files = {path};
  for (const Format* known : formats_meant(path, format)) {
    if (known->beside.extension) files.push_back(path_beside(path, known->beside.extension));
    if (known->read != read_medit && known->read != read_meshb) continue;
    for (const char* extension : {".sol", ".solb"}) files.push_back(path_beside(path, extension));
  }
  return files;
}

void check_writable(const std::string& path) {
  if (extension_of(path) == "/")
    check_folder_place(path);
  else
    check_file_place(path);
}

}  // namespace delfront
