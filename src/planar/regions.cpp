// SPDX-License-Identifier: Apache-2.0
// Parts are what unconstrained edges connect; part 0 is the outside with the ghosts. A part's depth is the number of
// segments between it and the outside; its winding number comes from the segments that part it from a shallower one.
#include <fmt/format.h>

#include <algorithm>

#include "planar/constrain.hpp"
#include "planar/kernel.hpp"

namespace delfront {

namespace {

constexpr std::uint32_t kNoPart = 0xffffffffu;
constexpr std::uint32_t kUnknown = 0xffffffffu;

struct Part {
  std::uint32_t depth = kUnknown;
  int winding = 0;
  bool is_undecided = false;
  bool touches_far_field = false;  ///< from the inside
  double area = 0;
  std::string name;
  double h = 1e300;
};

class Colouring {
 public:
  Colouring(const PlanarDomain& domain, const DomainOptions& options, PlanarGrid& grid)
      : domain_(domain), options_(options), grid_(grid), c_(grid.complex), part_of_(c_.tri.size(), kNoPart) {}

  void run() {
    find_parts();
    find_windings();
    std::vector<bool> keep = choose();
    name_parts(keep);
    colour(keep);
  }

 private:
  void find_parts() {
    TriIndex ghost = 0;
    while (!c_.is_ghost(ghost)) ++ghost;
    flood(ghost);
    for (TriIndex t = 0; t < c_.tri.size(); ++t)
      if (part_of_[t] == kNoPart) flood(t);
  }

  void flood(TriIndex start) {
    const auto part = static_cast<std::uint32_t>(parts_.size());
    parts_.push_back({});
    std::vector<TriIndex> stack{start};
    part_of_[start] = part;
    while (!stack.empty()) {
      const TriIndex t = stack.back();
      stack.pop_back();
      const Triangle& s = c_.tri[t];
      if (!c_.is_ghost(t)) {
        const Point2 a = c_.point[s.node[0]];
        parts_[part].area += 0.5 * cross(c_.point[s.node[1]] - a, c_.point[s.node[2]] - a);
      }
      for (unsigned e = 0; e < 3; ++e) {
        const TriIndex u = s.neigh[e] >> 2;
        if (s.flags >> e & 1 || part_of_[u] != kNoPart) continue;
        part_of_[u] = part;
        stack.push_back(u);
      }
    }
  }

  struct Border {
    std::uint32_t left, right;
    std::uint32_t curve;
  };

  void find_windings() {
    for (const PlanarPiece& piece : grid_.pieces) {
      const EdgeRef ref = c_.find_edge(piece.a, piece.b);
      const Border border{part_of_[ref >> 2], part_of_[c_.across(ref) >> 2], piece.curve};
      if (border.left != border.right) borders_.push_back(border);
    }
    parts_[0].depth = 0;
    // One sweep a depth: there are few depths.
    for (std::uint32_t depth = 1; reach(depth); ++depth) {
    }
  }

  /// Gives this depth to all parts that border on one of the depth before. @return whether there were any
  bool reach(std::uint32_t depth) {
    bool found = false;
    for (const Border& border : borders_) {
      for (const bool is_inwards_left : {true, false}) {
        const Part& from = parts_[is_inwards_left ? border.right : border.left];
        Part& to = parts_[is_inwards_left ? border.left : border.right];
        if (from.depth != depth - 1 || to.depth < depth) continue;
        const int winding = from.winding + (is_inwards_left ? 1 : -1);
        if (to.depth == kUnknown)
          to.winding = winding;
        else
          to.is_undecided |= to.winding != winding;
        to.is_undecided |= from.is_undecided;
        to.depth = depth;
        to.touches_far_field |= domain_.curves[CurveId(border.curve)].kind == "farfield";
        found = true;
      }
    }
    return found;
  }

  bool is_hole(const Part& part) const {
    return domain_.inner_loops == InnerLoops::by_direction && part.winding == 0 && !part.is_undecided;
  }

  std::vector<bool> choose() {
    std::vector<bool> keep(parts_.size(), false);
    const bool has_far_field =
        std::any_of(parts_.begin(), parts_.end(), [](const Part& part) { return part.touches_far_field; });
    std::size_t undecided = 0;
    for (std::size_t i = 1; i < parts_.size(); ++i) {
      keep[i] = options_.keep == "all" || (has_far_field ? parts_[i].touches_far_field : !is_hole(parts_[i]));
      undecided += domain_.inner_loops == InnerLoops::by_direction && parts_[i].is_undecided && keep[i];
    }
    if (undecided > 0 && !has_far_field)
      grid_.warnings.push_back(fmt::format(
          "{} regions are bounded by segments that run either way round; they are gridded (a hole is said by "
          "a seed, or by a loop against the one around it)",
          undecided));
    if (options_.keep == "largest" && parts_.size() > 1) {
      const auto largest = std::max_element(parts_.begin() + 1, parts_.end(),
                                            [](const Part& a, const Part& b) { return a.area < b.area; });
      keep.assign(keep.size(), false);
      keep[static_cast<std::size_t>(largest - parts_.begin())] = true;
    }
    if (!options_.keep_points.empty()) {
      keep.assign(keep.size(), false);
      for (const Point seed : options_.keep_points) keep[part_at({seed.x, seed.y}, "domain.keep: the point")] = true;
    }
    for (const Point2 hole : domain_.holes)
      if (const std::uint32_t part = part_at(hole, nullptr); part != kNoPart) keep[part] = false;
    if (std::find(keep.begin(), keep.end(), true) == keep.end())
      throw InputError(parts_.size() > 1 ? "every bounded part is a hole: there is nothing to grid"
                                         : "the segments bound nothing: close the loops");
    return keep;
  }

  /// @param what  for the message where there is no part; null: none is asked for there
  std::uint32_t part_at(Point2 at, const char* what) {
    PlanarKernel kernel(c_);
    kernel.last_tri = 0;
    const TriIndex t = kernel.locate(at, 0);
    if (!c_.is_ghost(t)) {
      const Triangle& s = c_.tri[t];
      for (unsigned e = 0; e < 3; ++e)
        if (s.flags >> e & 1 && orient2d(c_.point[s.node[next_of(e)]], c_.point[s.node[previous_of(e)]], at) == 0)
          throw InputError(fmt::format("the seed ({:g}, {:g}) lies on a segment; give a point inside", at.x, at.y),
                           {{{at.x, at.y, 0}, {}}});
      if (part_of_[t] != 0) return part_of_[t];
    }
    if (what)
      throw InputError(fmt::format("{} ({:g}, {:g}) lies outside of every closed line; give a point inside of a region",
                                   what, at.x, at.y),
                       {{{at.x, at.y, 0}, {}}});
    return kNoPart;
  }

  void name_parts(const std::vector<bool>& keep) {
    for (const PlanarSeed& seed : domain_.regions) {
      const std::uint32_t part = part_at(seed.at, nullptr);
      if (part == kNoPart || !keep[part]) {
        grid_.warnings.push_back(
            fmt::format("the seed of region '{}' at ({:g}, {:g}) lies in no region", seed.name, seed.at.x, seed.at.y));
        continue;
      }
      if (!seed.name.empty()) parts_[part].name = seed.name;
      if (seed.h) parts_[part].h = std::min(parts_[part].h, *seed.h);
    }
  }

  void colour(const std::vector<bool>& keep) {
    std::vector<std::uint32_t> colour_of(parts_.size(), kOutside);
    const auto give_colour = [&](std::uint32_t part) {
      if (!keep[part] || colour_of[part] != kOutside) return;
      const auto colour = static_cast<std::uint32_t>(grid_.region_names.size());
      colour_of[part] = colour;
      const std::string by_number = colour == 0 ? "fluid" : fmt::format("region_{}", colour + 1);
      grid_.region_names.push_back(parts_[part].name.empty() ? by_number : parts_[part].name);
      grid_.region_h.push_back(parts_[part].h);
    };
    for (const Border& border : borders_) {  // numbered in the order of the input
      give_colour(border.left);
      give_colour(border.right);
    }
    for (TriIndex t = 0; t < c_.tri.size(); ++t) c_.tri[t].region = colour_of[part_of_[t]];
  }

  const PlanarDomain& domain_;
  const DomainOptions& options_;
  PlanarGrid& grid_;
  TriComplex& c_;
  std::vector<std::uint32_t> part_of_;
  std::vector<Part> parts_;
  std::vector<Border> borders_;
};

}  // namespace

void colour_regions(const PlanarDomain& domain, const DomainOptions& options, PlanarGrid& grid) {
  Colouring(domain, options, grid).run();
}

}  // namespace delfront
