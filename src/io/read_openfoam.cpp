// SPDX-License-Identifier: Apache-2.0
// OpenFOAM polyMesh, ASCII. Patches become groups with their type as kind, cellZones regions, faceZones groups of inner
// faces. A pair of patches NAME_master and NAME_slave on the same points, as write_openfoam makes of a baffle, becomes
// the two-sided group NAME again.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/foam_cells.hpp"
#include "io/foam_text.hpp"
#include "io/formats.hpp"
#include "io/source.hpp"

namespace delfront {

namespace fs = std::filesystem;

namespace {

constexpr std::int64_t kMostIds = 0xfffffffe;

struct FoamPatch {
  std::string name, type;
  std::size_t start = 0, size = 0;
};

class FoamReader {
 public:
  FoamReader(const FoamFiles& files, std::string path, Context& context)
      : files_(files), path_(std::move(path)), context_(context) {}

  Mesh read() {
    read_points();
    read_faces();
    num_cells_ = read_owners();
    read_boundary();
    read_cell_zones();
    add_foam_cells(faces_, region_of_cell_, path_, mesh_);
    add_patches();
    read_face_zones();
    check_finite(mesh_, path_);
    return std::move(mesh_);
  }

 private:
  FoamText open(std::string_view bytes, const char* name, std::string_view wanted) {
    context_.check_limits();
    FoamText text(bytes, path_ + "/" + name);
    text.header(wanted);
    return text;
  }

  void read_points() {
    FoamText text = open(files_.points, "points", "vectorField");
    const std::size_t n = text.count("number of points", 7);
    text.expect("(");
    for (std::size_t i = 0; i < n; ++i) {
      text.expect("(");
      Point p;
      for (int k = 0; k < 3; ++k) p[k] = text.number("coordinate of a point");
      text.expect(")");
      mesh_.points.push_back(p);
    }
    text.expect(")");
  }

  void read_faces() {
    FoamText text = open(files_.faces, "faces", "faceList");
    const std::size_t n = text.count("number of faces", 4);
    const auto last = static_cast<std::int64_t>(mesh_.points.size()) - 1;
    text.expect("(");
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t corners = text.count("corners of a face", 2);
      if (corners < 3) text.fail("a face has fewer than three corners");
      text.expect("(");
      for (std::size_t k = 0; k < corners; ++k)
        faces_.corners.push_back(VertexId(static_cast<std::size_t>(text.integer("point", 0, last))));
      text.expect(")");
      faces_.offsets.push_back(faces_.corners.size());
    }
    text.expect(")");
  }

  std::vector<std::uint32_t> read_labels(FoamText& text, std::int64_t high) {
    const std::size_t n = text.count("number of labels", 2);
    std::vector<std::uint32_t> labels;
    text.expect("(");
    for (std::size_t i = 0; i < n; ++i) labels.push_back(static_cast<std::uint32_t>(text.integer("label", 0, high)));
    text.expect(")");
    return labels;
  }

  /// @return number of cells
  std::size_t read_owners() {
    FoamText text = open(files_.owner, "owner", "labelList");
    faces_.owner = read_labels(text, kMostIds);
    if (faces_.owner.size() != faces_.size())
      text.fail(fmt::format("{} owners of {} faces", faces_.owner.size(), faces_.size()));
    FoamText inner = open(files_.neighbour, "neighbour", "labelList");
    faces_.neighbour = read_labels(inner, kMostIds);
    if (faces_.neighbour.size() > faces_.size())
      inner.fail(fmt::format("{} neighbours of {} faces", faces_.neighbour.size(), faces_.size()));
    for (std::size_t face = 0; face < faces_.neighbour.size(); ++face)
      if (faces_.neighbour[face] == faces_.owner[face])
        inner.fail(fmt::format("face {} has cell {} on both sides", face, faces_.owner[face]));
    std::uint32_t last = 0;
    for (const std::uint32_t cell : faces_.owner) last = std::max(last, cell);
    for (const std::uint32_t cell : faces_.neighbour) last = std::max(last, cell);
    // As many cells as faces have sides, at most: what a file claims must not decide how much memory is taken.
    if (faces_.size() == 0 || last >= 2 * faces_.size()) text.fail("there are more cells than faces have sides");
    std::vector<bool> has_face(last + 1, false);
    for (const std::uint32_t cell : faces_.owner) has_face[cell] = true;
    for (const std::uint32_t cell : faces_.neighbour) has_face[cell] = true;
    const auto bare = std::find(has_face.begin(), has_face.end(), false);
    if (bare != has_face.end()) text.fail(fmt::format("cell {} has no face", bare - has_face.begin()));
    return has_face.size();
  }

  void read_boundary() {
    FoamText text = open(files_.boundary, "boundary", "polyBoundaryMesh");
    const std::size_t n = text.count("number of patches", 4);
    const auto num_faces = static_cast<std::int64_t>(faces_.size());
    text.expect("(");
    for (std::size_t i = 0; i < n; ++i) {
      FoamPatch patch;
      patch.name = text.next();
      text.expect("{");
      for (std::string_view key = text.next(); key != "}"; key = text.next()) {
        if (key.empty()) text.fail("a patch has no end; the file is truncated");
        if (key == "type") patch.type = text.peek();
        if (key == "nFaces") patch.size = static_cast<std::size_t>(text.integer("nFaces", 0, num_faces));
        if (key == "startFace") patch.start = static_cast<std::size_t>(text.integer("startFace", 0, num_faces));
        text.skip_entry();
      }
      if (patch.size > 0 && (patch.start < faces_.neighbour.size() || patch.start + patch.size > faces_.size()))
        text.fail(fmt::format("patch {} has faces {} to {}, and boundary faces are {} to {}", patch.name, patch.start,
                              patch.start + patch.size, faces_.neighbour.size(), faces_.size()));
      patches_.push_back(std::move(patch));
    }
    text.expect(")");
  }

  /// Calls `take(name, key)` for the keys of each zone; it reads the value, or says no.
  template <class Take>
  void read_zones(FoamText& text, const Take& take) {
    const std::size_t n = text.count("number of zones", 4);
    text.expect("(");
    for (std::size_t i = 0; i < n; ++i) {
      const std::string name(text.next());
      text.expect("{");
      for (std::string_view key = text.next(); key != "}"; key = text.next()) {
        if (key.empty()) text.fail("a zone has no end; the file is truncated");
        if (!take(name, key)) text.skip_entry();
      }
    }
    text.expect(")");
  }

  void begin_list(FoamText& text, std::string_view type) {
    if (text.peek() == type) text.next();
  }

  void read_cell_zones() {
    region_of_cell_.assign(num_cells_, GroupId());
    if (files_.cell_zones.empty()) return;
    FoamText text = open(files_.cell_zones, "cellZones", "");
    read_zones(text, [&](const std::string& name, std::string_view key) {
      if (key != "cellLabels") return false;
      begin_list(text, "List<label>");
      const GroupId group = mesh_.add_group(3, name);
      for (const std::uint32_t cell : read_labels(text, static_cast<std::int64_t>(num_cells_) - 1))
        region_of_cell_[cell] = group;
      text.expect(";");
      return true;
    });
  }

  static std::string kind_of_type(const std::string& type) { return type == "symmetryPlane" ? "symmetry" : type; }

  std::vector<std::vector<std::uint32_t>> sorted_faces(const FoamPatch& patch) const {
    std::vector<std::vector<std::uint32_t>> keys;
    for (std::size_t face = patch.start; face < patch.start + patch.size; ++face) {
      std::vector<std::uint32_t>& key = keys.emplace_back();
      for (const VertexId v : faces_[face]) key.push_back(v.value);
      std::sort(key.begin(), key.end());
    }
    std::sort(keys.begin(), keys.end());
    return keys;
  }

  /// @return the patch NAME_slave of this one, called NAME_master, where both lie on the same points
  std::optional<std::size_t> find_slave(const FoamPatch& master) const {
    if (!master.name.ends_with("_master") || master.size == 0) return std::nullopt;
    const std::string name = master.name.substr(0, master.name.size() - 6) + "slave";
    for (std::size_t i = 0; i < patches_.size(); ++i)
      if (patches_[i].name == name && patches_[i].size == master.size &&
          sorted_faces(patches_[i]) == sorted_faces(master))
        return i;
    return std::nullopt;
  }

  void add_patches() {
    std::vector<bool> is_slave(patches_.size(), false);
    std::map<std::size_t, std::string> baffles;  // masters, with the name of both
    for (std::size_t i = 0; i < patches_.size(); ++i)
      if (const auto slave = find_slave(patches_[i])) {
        is_slave[*slave] = true;
        baffles[i] = patches_[i].name.substr(0, patches_[i].name.size() - 7);
      }
    is_stored_.assign(faces_.size(), false);
    for (std::size_t i = 0; i < patches_.size(); ++i) {
      const FoamPatch& patch = patches_[i];
      if (is_slave[i]) continue;
      const auto baffle = baffles.find(i);
      const bool is_baffle = baffle != baffles.end();
      const GroupId group = mesh_.add_group(2, is_baffle ? baffle->second : patch.name, kind_of_type(patch.type));
      mesh_.groups[group].two_sided = is_baffle;
      for (std::size_t face = patch.start; face < patch.start + patch.size; ++face) store(face, group, false);
    }
  }

  void store(std::size_t face, GroupId group, bool is_flipped) {
    if (is_stored_[face]) return;  // in two patches or zones: one face is one face
    is_stored_[face] = true;
    std::vector<VertexId> corners(faces_[face].begin(), faces_[face].end());
    if (is_flipped) std::reverse(corners.begin(), corners.end());
    add_face(mesh_, corners, group);
  }

  void read_face_zones() {
    if (files_.face_zones.empty()) return;
    FoamText text = open(files_.face_zones, "faceZones", "");
    std::map<std::string, std::vector<std::uint32_t>> labels, flips;
    std::vector<std::string> names;
    read_zones(text, [&](const std::string& name, std::string_view key) {
      if (key != "faceLabels" && key != "flipMap") return false;
      const bool is_flips = key == "flipMap";
      begin_list(text, is_flips ? "List<bool>" : "List<label>");
      if (!is_flips) names.push_back(name);
      (is_flips ? flips : labels)[name] =
          read_labels(text, is_flips ? 1 : static_cast<std::int64_t>(faces_.size()) - 1);
      text.expect(";");
      return true;
    });
    for (const std::string& name : names) {
      const GroupId group = mesh_.add_group(2, name);
      mesh_.groups[group].two_sided = true;
      const std::vector<std::uint32_t>&faces = labels[name], &flip = flips[name];
      for (std::size_t i = 0; i < faces.size(); ++i)
        if (faces[i] < faces_.neighbour.size()) store(faces[i], group, i < flip.size() && flip[i] != 0);
    }
  }

  const FoamFiles& files_;
  std::string path_;
  Context& context_;
  Mesh mesh_;
  FoamFaceList faces_;
  std::size_t num_cells_ = 0;
  std::vector<FoamPatch> patches_;
  std::vector<GroupId> region_of_cell_;
  std::vector<bool> is_stored_;
};

std::string poly_mesh_folder(const std::string& path) {
  std::error_code ignored;
  for (const fs::path& folder : {fs::path(path) / "constant/polyMesh", fs::path(path) / "polyMesh", fs::path(path)})
    if (fs::exists(folder / "faces", ignored) || fs::exists(folder / "faces.gz", ignored)) return folder.string();
  throw InputError(fmt::format(
      "cannot read {}: it is a folder, not a file, and no OpenFOAM case (it has no constant/polyMesh)", path));
}

}  // namespace

Mesh read_foam_files(const FoamFiles& files, const std::string& path, Context& context) {
  return FoamReader(files, path, context).read();
}

Mesh read_openfoam(const std::string& path, Context& context) {
  const std::string folder = poly_mesh_folder(path);
  const char* const names[] = {"points", "faces", "owner", "neighbour", "boundary", "cellZones", "faceZones"};
  std::vector<FileBytes> bytes;
  std::string_view views[std::size(names)];
  for (std::size_t i = 0; i < std::size(names); ++i) {
    const fs::path file = fs::path(folder) / names[i];
    std::error_code ignored;
    if (!fs::exists(file, ignored) && fs::exists(file.string() + ".gz", ignored))
      throw InputError(fmt::format("{}.gz is compressed, which is not read; gunzip it", file.string()));
    if (i >= 5 && !fs::exists(file, ignored)) continue;  // zones need not be
    views[i] = bytes.emplace_back(file.string()).view();
  }
  return read_foam_files({views[0], views[1], views[2], views[3], views[4], views[5], views[6]}, folder, context);
}

}  // namespace delfront
