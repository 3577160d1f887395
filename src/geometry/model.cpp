// SPDX-License-Identifier: Apache-2.0
// From files' meshes to one model: weld by exact equality, cut polygons into triangles, give every face a named patch.
#include "delfront/model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
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

  Context& context_;
  Model model_;
  std::unordered_map<Point, VertexId, PointHash> welded_;
  std::vector<VertexId> to_model_;                   // by point of the input being added
  std::map<std::uint32_t, PatchId> patch_of_group_;  // of the input being added
  std::size_t num_points_read_ = 0, num_faces_ = 0;
  std::size_t num_bad_ = 0;  // faces with a coordinate that is not finite …
  std::vector<Place> bad_;   // … the first of them …
  std::string bad_stem_;     // … and the input they are in
};

std::vector<bool> points_on_faces(const Mesh& mesh, const std::string& stem) {
  std::vector<bool> used(mesh.points.size(), false);
  for (const CellBlock& block : mesh.blocks) {
    if (dimension(block.type) != 2) continue;
    for (VertexId v : block.vertices) {
      if (v.index() >= used.size())
        throw InputError(fmt::format("{}: a face names point {}, but there are only {}; the file is damaged", stem,
                                     v.value, used.size()));
      used[v.index()] = true;
    }
  }
  return used;
}

void ModelBuilder::weld(const NamedMesh& input) {
  const std::vector<bool> used = points_on_faces(input.mesh, input.stem);
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
    context_.log(LogLevel::info, fmt::format("{}: {} points belong to no face and are left out", input.stem, unused));
}

PatchId ModelBuilder::patch_for(const NamedMesh& input, GroupId group) {
  const auto known = patch_of_group_.find(group.value);
  if (known != patch_of_group_.end()) return known->second;
  const bool has_group = group.is_valid() && group.index() < input.mesh.groups.size();
  const std::string given = has_group ? input.mesh.groups[group].name : std::string();
  const std::string name = unused_patch_name(model_, given.empty() ? input.stem : given);
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

void ModelBuilder::add(const NamedMesh& input) {
  weld(input);
  patch_of_group_.clear();
  const std::size_t faces_before = num_faces_;
  for (const CellBlock& block : input.mesh.blocks) {
    if (dimension(block.type) != 2) continue;
    const std::size_t size = block.size();
    for (std::size_t i = 0; i < size; ++i) {
      if (num_faces_ % 65536 == 0) context_.check_limits();
      const GroupId group = i < block.group.size() ? block.group[i] : GroupId();
      add_face(block[i], patch_for(input, group), input.stem);
    }
  }
  if (num_faces_ == faces_before)
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
  if (model_.points.size() < num_points_read_)
    context_.log(LogLevel::info, fmt::format("welded {} equal points: {} are left",
                                             num_points_read_ - model_.points.size(), model_.points.size()));
  return std::move(model_);
}

}  // namespace

std::string unused_patch_name(const Model& model, const std::string& wanted) {
  auto is_taken = [&](const std::string& name) {
    return std::any_of(model.patches.begin(), model.patches.end(), [&](const Patch& p) { return p.name == name; });
  };
  if (!is_taken(wanted)) return wanted;
  int number = 2;
  while (is_taken(fmt::format("{}_{}", wanted, number))) ++number;
  return fmt::format("{}_{}", wanted, number);
}

Box Model::bounding_box() const {
  Box box;
  for (const Point& p : points) box.add(p);
  return box;
}

Model build_model(const std::vector<NamedMesh>& inputs, Context& context) {
  ModelBuilder builder(context);
  for (const NamedMesh& input : inputs) builder.add(input);
  return builder.finish();
}

}  // namespace delfront
