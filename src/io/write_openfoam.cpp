// SPDX-License-Identifier: Apache-2.0
// OpenFOAM polyMesh, ASCII. Internal faces in upper-triangular order, then one range a patch; cellZones for
// regions, unless there is one without a name. Groups of inner faces: between two regions a faceZone; with the same
// region on both sides a baffle, that is two patches NAME_master (the side that the stored faces' normals leave) and
// NAME_slave on the same points. The mesh is written into a hidden folder in constant/ that replaces polyMesh when it
// is whole.
#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/foam_case.hpp"
#include "io/foam_faces.hpp"
#include "io/formats.hpp"
#include "io/names.hpp"
#include "io/output.hpp"

namespace delfront {

namespace {

struct Patch {
  std::string name, type;
  std::size_t start = 0, size = 0;
};

/// Kinds that are patch types, or zones, or said otherwise (cyclic); the others become patches like any.
constexpr const char* kKinds[] = {"wall", "symmetry", "empty", "wedge", "patch", "interface", "cyclic"};

/// Patch type of a boundary kind; cyclic needs a partner that a grid alone does not name.
std::string patch_type(const Group& group, std::vector<std::string>& notes) {
  if (group.kind == "wall" || group.kind == "symmetry" || group.kind == "empty" || group.kind == "wedge")
    return group.kind;
  if (group.kind == "cyclic")
    notes.push_back(
        fmt::format("OpenFOAM: patch \"{}\" is written as type patch; cyclic needs its partner, set it with "
                    "createPatch",
                    group.name));
  return "patch";
}

/// One file of the mesh, checked to its close.
template <class Function>
void write_file(const std::string& folder, const char* name, const std::string& shown, const std::string& head,
                Function&& body) {
  Output out(folder + "/" + name, shown);
  out.text(head);
  body(out);
  out.close();
}

class FoamWriter {
 public:
  FoamWriter(const Mesh& mesh, Context& context, std::vector<std::string>& notes)
      : mesh_(mesh), context_(context), notes_(notes), faces_(build_foam_faces(mesh, context)) {
    names_ = fit_names(mesh, NameRule::foam_word, "OpenFOAM", notes, {mesh.dimension - 1, mesh.dimension});
    make_patches();
    if (faces_.num_loose > 0)
      notes.push_back(fmt::format("OpenFOAM: {} faces that bound no cell are left out", faces_.num_loose));
    note_left_out_fields(mesh, "OpenFOAM", notes);
    note_left_out_kinds(mesh, "OpenFOAM", notes, kKinds);
    note_left_out_curves(mesh, "OpenFOAM", notes);
    note_empty_groups(mesh, "OpenFOAM", notes);
  }

  void write(const std::string& folder, const std::string& shown) {
    write_points(folder, shown);
    write_faces(folder, shown);
    write_labels(
        folder, shown, "owner", [](const FoamFace& face) { return face.owner; }, true);
    write_labels(
        folder, shown, "neighbour", [](const FoamFace& face) { return face.neighbour; }, false);
    write_boundary(folder, shown);
    write_cell_zones(folder, shown);
    write_face_zones(folder, shown);
  }

 private:
  static constexpr const char* kLocation = "constant/polyMesh";

  /// Sorts the boundary faces by patch and makes the patches: groups in mesh order, baffles twice, the nameless last.
  void make_patches() {
    const std::size_t none = mesh_.groups.size();
    const auto slot = [&](const FoamFace& face) { return face.group == FoamFace::kNone ? none : face.group; };
    std::sort(faces_.boundary.begin(), faces_.boundary.end(), [&](const FoamFace& a, const FoamFace& b) {
      return std::tuple(slot(a), a.is_slave, a.owner, a.local) < std::tuple(slot(b), b.is_slave, b.owner, b.local);
    });
    std::set<std::string> taken;
    for (std::size_t i = 0; i < faces_.boundary.size(); ++i) {
      const FoamFace& face = faces_.boundary[i];
      const bool is_new =
          i == 0 || slot(face) != slot(faces_.boundary[i - 1]) || face.is_slave != faces_.boundary[i - 1].is_slave;
      if (is_new) begin_patch(face, faces_.internal.size() + i, taken);
      ++patches_.back().size;
    }
  }

  void begin_patch(const FoamFace& face, std::size_t start, std::set<std::string>& taken) {
    Patch patch{"defaultFaces", "patch", start, 0};
    if (face.group != FoamFace::kNone) {
      const Group& group = mesh_.groups[GroupId(std::size_t{face.group})];
      patch.name = names_[face.group];
      patch.type = faces_.is_baffle[face.group] && group.kind.empty() ? "wall" : patch_type(group, notes_);
      if (faces_.is_baffle[face.group]) {
        if (!face.is_slave)
          notes_.push_back(fmt::format("OpenFOAM: the inner patch \"{0}\" is written as two, {1}_master and {1}_slave",
                                       group.name, patch.name));
        patch.name += face.is_slave ? "_slave" : "_master";
      }
    }
    const std::string base = patch.name;
    for (int number = 2; !taken.insert(patch.name).second; ++number) patch.name = fmt::format("{}_{}", base, number);
    patches_.push_back(std::move(patch));
  }

  template <class Function>
  void for_each(Function&& take) const {
    for (const FoamFace& face : faces_.internal) take(face);
    for (const FoamFace& face : faces_.boundary) take(face);
  }
  std::size_t num_faces() const { return faces_.internal.size() + faces_.boundary.size(); }

  void write_points(const std::string& folder, const std::string& shown) {
    write_file(folder, "points", shown, foam_header("vectorField", kLocation, "points"), [&](Output& out) {
      out.text(fmt::format("{}\n(\n", mesh_.points.size()));
      for (const Point& p : mesh_.points) {
        out.character('(');
        out.real(p.x);
        out.character(' ');
        out.real(p.y);
        out.character(' ');
        out.real(p.z);
        out.text(")\n");
      }
      out.text(")\n");
    });
    context_.check_limits();
  }

  void write_faces(const std::string& folder, const std::string& shown) {
    write_file(folder, "faces", shown, foam_header("faceList", kLocation, "faces"), [&](Output& out) {
      out.text(fmt::format("{}\n(\n", num_faces()));
      for_each([&](const FoamFace& face) {
        const std::vector<VertexId> corners = faces_.corners(face);
        out.integer(static_cast<std::int64_t>(corners.size()));
        for (std::size_t k = 0; k < corners.size(); ++k) {
          out.character(k == 0 ? '(' : ' ');
          out.integer(corners[k].value);
        }
        out.text(")\n");
      });
      out.text(")\n");
    });
    context_.check_limits();
  }

  template <class Function>
  void write_labels(const std::string& folder, const std::string& shown, const char* name, Function&& label, bool all) {
    const std::string note = fmt::format("nPoints: {} nCells: {} nFaces: {} nInternalFaces: {}", mesh_.points.size(),
                                         faces_.num_cells(), num_faces(), faces_.internal.size());
    write_file(folder, name, shown, foam_header("labelList", kLocation, name, note), [&](Output& out) {
      out.text(fmt::format("{}\n(\n", all ? num_faces() : faces_.internal.size()));
      const auto take = [&](const FoamFace& face) {
        out.integer(label(face));
        out.character('\n');
      };
      for (const FoamFace& face : faces_.internal) take(face);
      if (all)
        for (const FoamFace& face : faces_.boundary) take(face);
      out.text(")\n");
    });
  }

  void write_boundary(const std::string& folder, const std::string& shown) {
    write_file(folder, "boundary", shown, foam_header("polyBoundaryMesh", kLocation, "boundary"), [&](Output& out) {
      out.text(fmt::format("{}\n(\n", patches_.size()));
      for (const Patch& patch : patches_)
        out.text(
            fmt::format("    {}\n    {{\n        type            {};\n        nFaces          {};\n"
                        "        startFace       {};\n    }}\n",
                        patch.name, patch.type, patch.size, patch.start));
      out.text(")\n");
    });
  }

  static void write_label_list(Output& out, const char* key, const std::vector<std::size_t>& labels) {
    out.text(fmt::format("    {} List<label>\n{}\n(\n", key, labels.size()));
    for (std::size_t label : labels) {
      out.integer(static_cast<std::int64_t>(label));
      out.character('\n');
    }
    out.text(")\n    ;\n");
  }

  void write_cell_zones(const std::string& folder, const std::string& shown) {
    std::vector<std::vector<std::size_t>> zones(mesh_.groups.size());
    std::size_t num_zones = 0;
    for (std::size_t b = 0; b < faces_.blocks.size(); ++b)
      for (std::size_t cell = 0; cell < faces_.blocks[b]->size(); ++cell)
        if (const std::int64_t group = group_of(*faces_.blocks[b], cell); group >= 0)
          zones[static_cast<std::size_t>(group)].push_back(faces_.first_cell[b] + cell);
    bool has_names = false;
    for (std::size_t group = 0; group < zones.size(); ++group) {
      num_zones += !zones[group].empty();
      has_names = has_names || (!zones[group].empty() && !mesh_.groups[GroupId(group)].name.empty());
    }
    if (num_zones < 2 && !has_names) return;
    write_file(folder, "cellZones", shown, foam_header("regIOobject", kLocation, "cellZones"), [&](Output& out) {
      out.text(fmt::format("{}\n(\n", num_zones));
      for (std::size_t group = 0; group < zones.size(); ++group) {
        if (zones[group].empty()) continue;
        out.text(fmt::format("{}\n{{\n    type cellZone;\n", names_[group]));
        write_label_list(out, "cellLabels", zones[group]);
        out.text("}\n");
      }
      out.text(")\n");
    });
  }

  void write_face_zones(const std::string& folder, const std::string& shown) {
    std::vector<std::vector<std::size_t>> zones(mesh_.groups.size());
    std::size_t num_zones = 0;
    for (std::size_t i = 0; i < faces_.internal.size(); ++i)
      if (const std::uint32_t group = faces_.internal[i].group; group != FoamFace::kNone) zones[group].push_back(i);
    for (const auto& zone : zones) num_zones += !zone.empty();
    if (num_zones == 0) return;
    write_file(folder, "faceZones", shown, foam_header("regIOobject", kLocation, "faceZones"), [&](Output& out) {
      out.text(fmt::format("{}\n(\n", num_zones));
      for (std::size_t group = 0; group < zones.size(); ++group) {
        if (zones[group].empty()) continue;
        out.text(fmt::format("{}\n{{\n    type faceZone;\n", names_[group]));
        write_label_list(out, "faceLabels", zones[group]);
        out.text(fmt::format("    flipMap List<bool>\n{}\n(\n", zones[group].size()));
        for (std::size_t i : zones[group]) out.text(faces_.internal[i].is_flipped ? "1\n" : "0\n");
        out.text(")\n    ;\n}\n");
      }
      out.text(")\n");
    });
  }

  const Mesh& mesh_;
  Context& context_;
  std::vector<std::string>& notes_;
  FoamFaces faces_;
  std::vector<std::string> names_;
  std::vector<Patch> patches_;
};

}  // namespace

void write_openfoam(const Mesh& mesh, const std::string& path, Context& context, std::vector<std::string>& notes) {
  if (mesh.num_cells_of_dimension(3) == 0)
    throw InputError(
        "OpenFOAM needs a grid of volume cells, and this mesh has none; extrude a 2-D grid by one cell, "
        "write surfaces as stl or obj");
  check_folder_place(path);
  std::string folder = path;
  while (folder.size() > 1 && folder.ends_with('/')) folder.pop_back();
  FoamWriter writer(mesh, context, notes);
  CaseFolders folders;
  folders.make(folder);
  folders.make(folder + "/constant");
  Replacement replacement(folder + "/constant/polyMesh", Replacement::Of::folder);
  writer.write(replacement.temporary(), folder + "/constant/polyMesh");
  replacement.commit();
  write_minimal_system(folder, folders);
  folders.keep();
}

}  // namespace delfront
