// SPDX-License-Identifier: Apache-2.0
// From files' meshes to one model: weld by exact equality, cut polygons into triangles, give every face a named patch.
#include "delfront/model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <set>
#include <unordered_map>

#include "delfront/findings.hpp"
#include "geometry/patches.hpp"
#include "geometry/polygon.hpp"

namespace delfront {
namespace {

struct PointHash {
  std::size_t operator()(const Point& p) const noexcept {
    std::uint64_t hash = 0;
    for (int k = 0; k < 3; ++k) {
      hash ^= std::bit_cast<std::uint64_t>(p[k]);
      hash *= 0x9e3779b97f4a7c15ull;
      hash ^= hash >> 32;
    }
    return hash;
  }
};

class ModelBuilder {
 public:
  explicit ModelBuilder(Context& context) : context_(context) {}
  void add(const NamedMesh& input);
  Model finish();

 private:
  void weld(const NamedMesh& input);
  PatchId patch_for(const NamedMesh& input, GroupId group);
  void add_face(std::span<const VertexId> corners, PatchId patch, const std::string& stem);
  void add_curves(const NamedMesh& input);
  void add_corners(const NamedMesh& input);
  void add_regions(const NamedMesh& input);
  void note_sides(const NamedMesh& input, std::size_t face, std::size_t first_triangle);

  Context& context_;
  Model model_;
  std::unordered_map<Point, VertexId, PointHash> welded_;
  std::vector<VertexId> to_model_;  // by point of the input being added
  PatchNames patch_names_;
  std::map<std::uint32_t, PatchId> patch_of_group_;  // of the input being added
  std::set<std::array<VertexId, 2>> curve_edges_;    // lower end first
  std::set<VertexId> is_corner_;
  std::set<std::string> region_names_;
  std::map<std::string, std::size_t> region_number_;  // the last that a name has got
  std::size_t first_region_ = 0;                      // of the input being added
  std::size_t num_repeated_lines_ = 0;
  std::size_t num_points_read_ = 0, num_faces_ = 0;
  std::size_t num_bad_ = 0;  // faces with a coordinate that is not finite …
  std::vector<Place> bad_;   // … the first of them …
  std::string bad_stem_;     // … and the input they are in
};

/// Of faces, and of the lines and vertices that stay as curves and corners.
std::vector<bool> points_on_model(const Mesh& mesh, const std::string& stem) {
  std::vector<bool> used(mesh.points.size(), false);
  for (const CellBlock& block : mesh.blocks) {
    if (dimension(block.type) > 2) continue;
    for (VertexId v : block.vertices) {
      if (v.index() >= used.size())
        throw InputError(fmt::format("{}: a {} names point {}, but there are only {}; the file is damaged", stem,
                                     dimension(block.type) == 2 ? "face" : name_of(block.type), v.value, used.size()));
      used[v.index()] = true;
    }
  }
  return used;
}

void ModelBuilder::weld(const NamedMesh& input) {
  const std::vector<bool> used = points_on_model(input.mesh, input.stem);
  to_model_.assign(input.mesh.points.size(), {});
  for (std::size_t i = 0; i < used.size(); ++i) {
    Point p = input.mesh.points[VertexId(i)];
    if (!used[i] || !is_finite(p)) continue;  // add_face() reports the latter
    for (int k = 0; k < 3; ++k) p[k] += 0.0;  // -0 becomes +0
    const auto [it, is_new] = welded_.try_emplace(p, model_.points.next_id());
    if (is_new) model_.points.push_back(p);
    to_model_[i] = it->second;
    ++num_points_read_;
  }
  const auto unused = std::count(used.begin(), used.end(), false);
  if (unused > 0)
    context_.log(LogLevel::info,
                 fmt::format("{}: {} points belong to no face, line or vertex and are left out", input.stem, unused));
}

PatchId ModelBuilder::patch_for(const NamedMesh& input, GroupId group) {
  const auto known = patch_of_group_.find(group.value);
  if (known != patch_of_group_.end()) return known->second;
  const bool has_group = group.is_valid() && group.index() < input.mesh.groups.size();
  const std::string given = has_group ? input.mesh.groups[group].name : std::string();
  const std::string name = patch_names_.take(given.empty() ? input.stem : given);
  if (!given.empty() && name != given)
    context_.log(LogLevel::info,
                 fmt::format("{}: patch '{}' is called '{}' here, as the name is taken", input.stem, given, name));
  const PatchId id = model_.patches.next_id();
  model_.patches.push_back({name, has_group ? input.mesh.groups[group].kind : std::string()});
  patch_of_group_.emplace(group.value, id);
  return id;
}

void ModelBuilder::add_face(std::span<const VertexId> corners, PatchId patch, const std::string& stem) {
  const auto face = static_cast<std::uint32_t>(num_faces_++);
  if (corners.size() < 3)
    throw InputError(fmt::format("{}: face {} has {} corners; a face needs three", stem, face, corners.size()));
  std::vector<Point> places;
  for (VertexId v : corners)
    if (to_model_[v.index()].is_valid()) places.push_back(model_.points[to_model_[v.index()]]);
  if (places.size() < corners.size()) {
    if (num_bad_++ == 0) bad_stem_ = stem;
    if (bad_.size() < kMaxPlaces) bad_.push_back({places.empty() ? Point{} : places[0], {face}});
    return;
  }
  auto add_triangle = [&](int a, int b, int c) {
    auto vertex = [&](int corner) { return to_model_[corners[std::size_t(corner)].index()]; };
    model_.triangles.push_back({vertex(a), vertex(b), vertex(c)});
    model_.patch_of_triangle.push_back(patch);
    model_.input_face.push_back(face);
  };
  if (corners.size() == 3) return add_triangle(0, 1, 2);
  for (const auto& [a, b, c] : triangulate_polygon(places)) add_triangle(a, b, c);
}

std::string group_name(const Mesh& mesh, const CellBlock& block, std::size_t cell, const char* unnamed) {
  const GroupId group = cell < block.group.size() ? block.group[cell] : GroupId();
  const bool is_named = group.is_valid() && group.index() < mesh.groups.size() && !mesh.groups[group].name.empty();
  return is_named ? mesh.groups[group].name : unnamed;
}

/// Lines that follow each other under one name make one curve; a line that repeats an earlier one is left out.
void ModelBuilder::add_curves(const NamedMesh& input) {
  const CellBlock* lines = input.mesh.find_block(CellType::line);
  if (!lines) return;
  bool goes_on = false;
  for (std::size_t i = 0; i < lines->size(); ++i) {
    const auto ends = (*lines)[i];
    const VertexId a = to_model_[ends[0].index()], b = to_model_[ends[1].index()];
    if (!a.is_valid() || !b.is_valid())
      throw InputError(fmt::format("{}: line {} has a coordinate that is not a finite number", input.stem, i));
    if (a != b && !curve_edges_.insert({std::min(a, b), std::max(a, b)}).second) {
      ++num_repeated_lines_;
      goes_on = false;
      continue;
    }
    const std::string name = group_name(input.mesh, *lines, i, "curves");
    const std::size_t num_curves = model_.curves.size();
    Curve* last = goes_on ? &model_.curves[CurveId(num_curves - 1)] : nullptr;
    if (last && last->vertices.back() == a && last->name == name)
      last->vertices.push_back(b);
    else
      model_.curves.push_back({name, {a, b}});
    goes_on = true;
  }
}

void ModelBuilder::add_corners(const NamedMesh& input) {
  const CellBlock* vertices = input.mesh.find_block(CellType::vertex);
  if (!vertices) return;
  for (std::size_t i = 0; i < vertices->size(); ++i) {
    const VertexId v = to_model_[(*vertices)[i][0].index()];
    if (!v.is_valid())
      throw InputError(fmt::format("{}: vertex {} has a coordinate that is not a finite number", input.stem, i));
    if (!is_corner_.insert(v).second) continue;
    model_.corners.push_back(v);
    model_.corner_names.push_back(group_name(input.mesh, *vertices, i, "points"));
  }
}

/// Names that several have are numbered: name, name_2, …
void ModelBuilder::add_regions(const NamedMesh& input) {
  first_region_ = model_.regions.size();
  for (const std::string& given : input.regions) {
    std::string name = given;
    std::size_t& number = region_number_.try_emplace(given, 1).first->second;
    while (!given.empty() && !region_names_.insert(name).second) name = fmt::format("{}_{}", given, ++number);
    model_.regions.push_back({name});
  }
}

/// Of the triangles that the last face became.
void ModelBuilder::note_sides(const NamedMesh& input, std::size_t face, std::size_t first_triangle) {
  if (face >= input.sides.size()) return;
  std::array<RegionId, 2> sides = input.sides[face];
  for (RegionId& region : sides)
    if (region.is_valid()) region = RegionId(region.index() + first_region_);
  model_.sides.resize(first_triangle);  // what came before may have none
  while (model_.sides.size() < model_.triangles.size()) model_.sides.push_back(sides);
}

void ModelBuilder::add(const NamedMesh& input) {
  weld(input);
  add_regions(input);
  add_curves(input);
  add_corners(input);
  patch_of_group_.clear();
  const std::size_t faces_before = num_faces_;
  for (const CellBlock& block : input.mesh.blocks) {
    if (dimension(block.type) != 2) continue;
    const std::size_t size = block.size();
    for (std::size_t i = 0; i < size; ++i) {
      if (num_faces_ % 65536 == 0) context_.check_limits();
      const GroupId group = i < block.group.size() ? block.group[i] : GroupId();
      const std::size_t face = num_faces_ - faces_before, first_triangle = model_.triangles.size();
      add_face(block[i], patch_for(input, group), input.stem);
      note_sides(input, face, first_triangle);
    }
  }
  if (num_faces_ == faces_before && !input.mesh.find_block(CellType::line) && !input.mesh.find_block(CellType::vertex))
    throw InputError(fmt::format("{}: no faces in it; a surface of triangles or polygons is needed", input.stem));
}

/// What the exact predicates hold, and products of three lengths too (predicates.hpp).
void check_range(const Model& model) {
  constexpr double kLargest = 0x1p100, kSmallest = 0x1p-100;
  for (std::size_t v = 0; v < model.points.size(); ++v) {
    const Point p = model.points[VertexId(v)];
    const double largest = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    if (largest > kLargest)
      throw InputError(
          fmt::format("a coordinate is {:g}, and nothing above {:.2g} can be handled; export the surface in "
                      "another unit, or repair the damaged number",
                      largest, kLargest),
          {{p, {static_cast<std::uint32_t>(v)}}});
  }
  const double side = model.bounding_box().longest_side();
  if (side > 0 && side < kSmallest)
    throw InputError(
        fmt::format("the surface is only {:g} long, and nothing below {:.2g} can be handled; export it in a "
                    "smaller unit",
                    side, kSmallest));
}

Model ModelBuilder::finish() {
  if (num_faces_ == 0) throw InputError("no faces at all: name at least one file with a surface");
  if (num_bad_ > 0) {
    const std::string message = fmt::format(
        "{}: {} a coordinate that is not a finite number, the first is face {} (counted from 0); export the "
        "surface again",
        bad_stem_, num_bad_ == 1 ? "1 face has" : fmt::format("{} faces have", num_bad_), bad_[0].ids[0]);
    throw InputError(message, std::move(bad_));
  }
  check_range(model_);
  if (num_repeated_lines_ > 0)
    context_.log(LogLevel::info, fmt::format("{} lines repeat earlier ones and are left out", num_repeated_lines_));
  if (model_.points.size() < num_points_read_)
    context_.log(LogLevel::info, fmt::format("welded {} equal points: {} are left",
                                             num_points_read_ - model_.points.size(), model_.points.size()));
  return std::move(model_);
}

}  // namespace

std::string PatchNames::take(const std::string& wanted) {
  const auto [it, is_new] = next_number_.try_emplace(wanted, 2);
  if (is_new) return wanted;
  int& number = it->second;
  while (true) {
    std::string name = fmt::format("{}_{}", wanted, number++);
    if (next_number_.try_emplace(name, 2).second) return name;
  }
}

std::string unused_patch_name(const Model& model, const std::string& wanted) {
  PatchNames names;
  for (const Patch& patch : model.patches) names.take(patch.name);
  return names.take(wanted);
}

Box Model::bounding_box() const {
  Box box;
  for (const Point& p : points) box.add(p);
  return box;
}

Box Model::surface_box() const {
  Box box;
  for (const std::array<VertexId, 3>& triangle : triangles)
    for (const VertexId v : triangle) box.add(points[v]);
  return box;
}

Model build_model(const std::vector<NamedMesh>& inputs, Context& context) {
  ModelBuilder builder(context);
  for (const NamedMesh& input : inputs) builder.add(input);
  return builder.finish();
}

}  // namespace delfront
