// SPDX-License-Identifier: Apache-2.0
// Starter files are made whole in memory, then written one by one, each only where nothing of its name is.
#include "io/starter.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <unordered_map>

#include "delfront/errors.hpp"
#include "io/foam_case.hpp"

namespace delfront {

namespace fs = std::filesystem;

namespace {

/// Area vector times two of a face, or a line turned by a quarter.
Point area_vector(const Mesh& mesh, std::span<const VertexId> corners) {
  const Point a = mesh.points[corners[0]];
  if (corners.size() == 2) {
    const Point b = mesh.points[corners[1]];
    return {b.y - a.y, a.x - b.x, 0};
  }
  Point sum;
  for (std::size_t k = 1; k + 1 < corners.size(); ++k)
    sum = sum + cross(mesh.points[corners[k]] - a, mesh.points[corners[k + 1]] - a);
  return sum;
}

/// The faces of a group (in the plane: lines), each to be found by its vertices.
class FacesOfGroup {
 public:
  FacesOfGroup(const Mesh& mesh, GroupId group) {
    for (const CellBlock& block : mesh.blocks) {
      if (dimension(block.type) != mesh.dimension - 1) continue;
      for (std::size_t cell = 0; cell < block.group.size(); ++cell) {
        if (block.group[cell] != group) continue;
        Face face{{block[cell].begin(), block[cell].end()}, area_vector(mesh, block[cell])};
        std::sort(face.corners.begin(), face.corners.end());
        by_first_corner_.emplace(face.corners.front().index(), faces_.size());
        faces_.push_back(std::move(face));
      }
    }
  }

  double total_area() const {
    double sum = 0;
    for (const Face& face : faces_) sum += length(face.area);
    return sum;
  }

  /// Sum of the area vectors, each turned towards its cell; one whose cell is a polyhedron, from outward as it is
  /// stored.
  Point inward_area(const Mesh& mesh) const {
    std::vector<int> signs(faces_.size(), -1);
    for (const CellBlock& block : mesh.blocks)
      if (dimension(block.type) == mesh.dimension && block.type != CellType::polyhedron)
        for (std::size_t cell = 0; cell < block.size(); ++cell) look_at_cell(mesh, block[cell], signs);
    Point sum;
    for (std::size_t f = 0; f < faces_.size(); ++f) sum = sum + static_cast<double>(signs[f]) * faces_[f].area;
    return sum;
  }

 private:
  struct Face {
    std::vector<VertexId> corners;  // sorted
    Point area;
  };

  static Point middle(const Mesh& mesh, std::span<const VertexId> corners) {
    Point sum;
    for (VertexId v : corners) sum = sum + mesh.points[v];
    return (1 / static_cast<double>(corners.size())) * sum;
  }

  void look_at_cell(const Mesh& mesh, std::span<const VertexId> cell, std::vector<int>& signs) const {
    for (VertexId v : cell) {
      const auto [begin, end] = by_first_corner_.equal_range(v.index());
      for (auto it = begin; it != end; ++it) {
        const Face& face = faces_[it->second];
        const bool is_of_cell = std::all_of(face.corners.begin(), face.corners.end(), [&](VertexId corner) {
          return std::find(cell.begin(), cell.end(), corner) != cell.end();
        });
        if (is_of_cell)
          signs[it->second] = dot(middle(mesh, cell) - middle(mesh, face.corners), face.area) > 0 ? 1 : -1;
      }
    }
  }

  std::vector<Face> faces_;
  std::unordered_multimap<std::size_t, std::size_t> by_first_corner_;
};

std::string read_text(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

bool holds_word(const std::string& text, const std::string& word) {
  const auto is_part = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-'; };
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || !is_part(text[at - 1])) && (end == text.size() || !is_part(text[end]))) return true;
  }
  return false;
}

/// A grid made anew may have boundaries that a file of an earlier run does not name. Patterns and included files are
/// not looked into.
void note_missing_names(const StarterFile& file, const std::vector<StarterBoundary>& boundaries,
                        std::vector<std::string>& notes) {
  if (!file.names_boundaries) return;
  const std::string text = read_text(file.path);
  if (text.find("#include") != std::string::npos || text.find('*') != text.rfind('*')) return;
  std::vector<std::string> missing;
  for (const StarterBoundary& boundary : boundaries)
    if (!holds_word(text, boundary.name)) missing.push_back(boundary.name);
  if (!missing.empty())
    notes.push_back(fmt::format("{} was there and is kept, but does not name {}; remove it to have it made anew",
                                file.path, fmt::join(missing, ", ")));
}

/// A file, a link to nowhere, or the file compressed as OpenFOAM does.
bool is_taken(const std::string& path) {
  std::error_code ignored;
  return fs::exists(fs::symlink_status(path, ignored)) || fs::exists(fs::symlink_status(path + ".gz", ignored));
}

void write_files(const std::vector<StarterFile>& files, const std::vector<StarterBoundary>& boundaries,
                 Context& context, StarterFiles& result) {
  for (const StarterFile& file : files) {
    context.check_limits();
    std::error_code ignored;
    const bool is_ours = !file.replaceable.empty() && fs::is_regular_file(fs::symlink_status(file.path, ignored)) &&
                         read_text(file.path) == file.replaceable;
    if (is_taken(file.path) && !is_ours) {
      result.kept.push_back(file.path);
      note_missing_names(file, boundaries, result.notes);
      continue;
    }
    write_whole(file.path, file.text);
    result.written.push_back(file.path);
  }
}

void note_assumed_walls(std::vector<StarterBoundary>& boundaries, const std::string& path,
                        std::vector<std::string>& notes) {
  std::vector<std::string> names;
  for (StarterBoundary& boundary : boundaries) {
    const std::string& kind = boundary.kind;
    boundary.is_wall_by_default = kind.empty() || kind == "patch" || kind == "cyclic" || kind == "interface";
    if (boundary.is_wall_by_default) names.push_back(boundary.name);
  }
  if (!names.empty())
    notes.push_back(
        fmt::format("starter files of {}: no kind says what happens at {}, so a wall is assumed; give their "
                    "kinds, e.g. boundaries.NAME.kind = \"inlet\", by the names they have in the input",
                    path, fmt::join(names, ", ")));
}

/// OpenFOAM has these for grids one cell thick, or wedges of one cell; no grid of tetrahedra is either.
void note_flat_kinds(const std::vector<StarterBoundary>& boundaries, const std::string& path,
                     std::vector<std::string>& notes) {
  std::vector<std::string> names;
  for (const StarterBoundary& boundary : boundaries)
    if (boundary.patch_type == "empty" || boundary.patch_type == "wedge") names.push_back(boundary.name);
  if (!names.empty())
    notes.push_back(
        fmt::format("{}: OpenFOAM has the kinds empty and wedge for grids one cell thick, and refuses {} in this one; "
                    "symmetry is what a plane of symmetry needs",
                    path, fmt::join(names, ", ")));
}

StarterFiles start_su2(const Mesh& mesh, const std::string& path, Context& context) {
  StarterFiles result;
  if (const std::string name = fs::path(path).filename().string(); name.find_first_of(" \t%") != std::string::npos)
    result.notes.push_back(
        fmt::format("'{}': SU2 takes blanks and % for the end of a file's name; give the grid another one", name));
  std::vector<StarterBoundary> boundaries = su2_boundaries(mesh);
  note_assumed_walls(boundaries, path, result.notes);
  write_files({su2_starter(mesh, path, boundaries)}, boundaries, context, result);
  return result;
}

StarterFiles start_openfoam(const Mesh& mesh, const std::string& path, Context& context) {
  StarterFiles result;
  std::string folder = path;
  while (folder.size() > 1 && folder.ends_with('/')) folder.pop_back();
  std::vector<StarterBoundary> boundaries = foam_boundaries(mesh, folder);
  note_assumed_walls(boundaries, path, result.notes);
  note_flat_kinds(boundaries, path, result.notes);
  CaseFolders folders;
  for (const char* part : {"0", "constant", "system"}) folders.make(fmt::format("{}/{}", folder, part));
  write_files(foam_starter(folder, boundaries), boundaries, context, result);
  return result;
}

}  // namespace

Point inward_direction(const Mesh& mesh, GroupId group) {
  const FacesOfGroup faces(mesh, group);
  const Point area = faces.inward_area(mesh);
  const double size = length(area);
  if (!(size > 1e-6 * faces.total_area())) return {1, 0, 0};
  Point inward = (1 / size) * area;
  for (int k = 0; k < 3; ++k) inward[k] = std::round(inward[k] * 1e6) / 1e6 + 0.0;  // no -0
  return inward;
}

std::string wall_note(const StarterBoundary& boundary, const char* comment) {
  if (!boundary.is_wall_by_default) return "";
  if (boundary.kind.empty()) return fmt::format("  {} no kind was given: assumed a wall", comment);
  return fmt::format("  {} its kind, {}, says no condition: assumed a wall", comment, boundary.kind);
}

const std::vector<std::string>& starter_solvers() {
  static const std::vector<std::string> solvers = {"su2", "openfoam"};
  return solvers;
}

StarterFiles write_starter_files(const Mesh& mesh, const std::string& path, const std::string& solver, Context& context,
                                 const std::string& format) {
  const std::vector<std::string>& known = starter_solvers();
  if (std::find(known.begin(), known.end(), solver) == known.end())
    throw UsageError(fmt::format("solver '{}': starter files are made for {}", solver, fmt::join(known, ", ")));
  if (const FormatInfo& found = format_of(path, format, true); found.name != solver)
    throw UsageError(fmt::format("{} is a file of {}, and starter files for {} need a grid of that solver", path,
                                 found.title, solver));
  try {
    return solver == "su2" ? start_su2(mesh, path, context) : start_openfoam(mesh, path, context);
  } catch (const IoError& e) {
    throw IoError(fmt::format("{}; the grid {} itself is complete", e.what(), path));
  }
}

}  // namespace delfront
