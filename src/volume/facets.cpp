// SPDX-License-Identifier: Apache-2.0
// One facet at a time: its Delaunay triangulation in its own plane ("subfaces"), those subfaces that the complex lacks,
// the tets that they cut ("cavity"), and the two polyhedra above and below, filled again.
#include "volume/facets.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <unordered_map>

#include "volume/visible_point.hpp"

namespace delfront {

namespace {

using Face = std::array<VertexIndex, 3>;

Face sorted(Face f) {
  std::sort(f.begin(), f.end());
  return f;
}

class FacetRecovery {
 public:
  FacetRecovery(TetComplex& complex, const Model& model, const Segments& segments, const EdgeSet& required)
      : c_(complex), model_(model), segments_(segments), required_(required) {}

  std::size_t num_missing = 0;
  const std::vector<Face>& subfaces() const { return subfaces_; }

  bool recover(TriangleId id) {
    for (std::size_t k = 0; k < 3; ++k) corner_[k] = model_.triangles[id][k].value;
    if (!build_subfaces(id)) return false;
    missing_.clear();
    for (const Face& f : subfaces_) {
      const FaceRef ref = c_.find_face(f[0], f[1], f[2], scratch_);
      if (ref == kNoIndex)
        missing_.push_back(f);
      else
        c_.set_constrained_both(ref, true);
    }
    if (!missing_.empty()) ++num_missing;
    follow_complex();
    while (!missing_.empty())
      if (!recover_connected_part()) return false;
    return true;
  }

 private:
  /// Steiner points make the facet's outline a polygon, convex with collinear points: triangulate it, Delaunay.
  bool build_subfaces(TriangleId id) {
    outline_.clear();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t e = segments_.of_triangle[id.index()][k];
      segments_.vertices_along(e, segments_.ends[e][0] != corner_[k], along_);
      outline_.insert(outline_.end(), along_.begin(), along_.end() - 1);
    }
    subfaces_.clear();
    if (outline_.size() == 3) {
      subfaces_.push_back(corner_);
      return true;
    }
    apex_ = find_apex();
    return apex_ != kNoIndex && triangulate(0, outline_.size() - 1);
  }

  /// Flips leave other diagonals in the facet's plane than Delaunay's: two missing subfaces may be there as two others.
  void follow_complex() {
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t i = 0; i < missing_.size() && !changed; ++i)
        for (std::size_t j = i + 1; j < missing_.size() && !changed; ++j) changed = swap_diagonal(i, j);
    }
  }

  bool swap_diagonal(std::size_t i, std::size_t j) {
    const Face f = missing_[i], g = missing_[j];
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexIndex u = f[k], v = f[(k + 1) % 3], x = f[(k + 2) % 3];
      for (std::size_t m = 0; m < 3; ++m) {
        if (g[m] != v || g[(m + 1) % 3] != u) continue;
        const VertexIndex y = g[(m + 2) % 3];
        const FaceRef one = c_.find_face(x, y, u, scratch_), two = c_.find_face(x, y, v, scratch_);
        if (one == kNoIndex || two == kNoIndex) return false;
        for (const FaceRef ref : {one, two}) c_.set_constrained_both(ref, true);
        missing_.erase(missing_.begin() + static_cast<std::ptrdiff_t>(j));
        missing_.erase(missing_.begin() + static_cast<std::ptrdiff_t>(i));
        std::erase(subfaces_, f);
        std::erase(subfaces_, g);
        subfaces_.push_back({x, u, y});
        subfaces_.push_back({y, v, x});
        return true;
      }
    }
    return false;
  }

  /// Any vertex off the facet's plane: it turns the in-circle test into an in-sphere test. On the positive side, if it
  /// can.
  VertexIndex find_apex() {
    c_.star(corner_[0], scratch_);
    for (const TetIndex t : scratch_)
      for (unsigned k = 0; k < 4; ++k) {
        const VertexIndex v = c_.node[4 * t + k];
        if (v != kGhost && side(v) != 0) return v;
      }
    return kNoIndex;
  }

  int side(VertexIndex v) const { return c_.orient(corner_[0], corner_[1], corner_[2], v); }

  /// Triangulates the outline's vertices i … j, below the edge from i to j.
  bool triangulate(std::size_t i, std::size_t j) {
    if (j - i < 2) return true;
    const int up = side(apex_);
    std::size_t best = 0;
    for (std::size_t m = i + 1; m < j; ++m) {
      const VertexIndex a = outline_[i], b = outline_[j], w = outline_[m];
      if (c_.orient(a, w, b, apex_) * up <= 0) continue;  // on the line through a and b
      if (best == 0 || insphere_perturbed(c_.exact(up > 0 ? a : b), c_.exact(outline_[best]), c_.exact(up > 0 ? b : a),
                                          c_.exact(apex_), c_.exact(w)) > 0)
        best = m;
    }
    if (best == 0) return false;
    subfaces_.push_back({outline_[i], outline_[best], outline_[j]});
    return triangulate(i, best) && triangulate(best, j);
  }

  /// Takes the missing subfaces that hang together with the last one out of the list, and puts them into the complex.
  bool recover_connected_part() {
    take_part();
    TetIndex start = kNoIndex;
    for (const Face& f : part_) {
      for (std::size_t k = 0; k < 3 && start == kNoIndex; ++k)
        start = find_cut_tet(f[k], f[(k + 1) % 3], f[(k + 2) % 3]);
      if (start != kNoIndex) break;
    }
    cavity_.clear();
    if (start == kNoIndex || !collect_cavity(start)) return unmark(false);
    std::vector<std::array<VertexIndex, 4>> made;
    if (!fill_half(+1, made) || !fill_half(-1, made) || loses_required_edge(made) || !closes(made))
      return unmark(false);
    unmark(true);
    keep_.clear();
    for (const Face& f : inner_constrained_) keep_.insert(sorted(f));
    for (const Face& f : part_) keep_.insert(sorted(f));
    c_.replace(cavity_, made, new_tets_);
    for (const TetIndex t : new_tets_)
      for (unsigned f = 0; f < 4; ++f)
        if (keep_.contains(sorted(c_.face_nodes(4 * t + f)))) c_.set_constrained_both(4 * t + f, true);
    return true;
  }

  void take_part() {
    part_.assign(1, missing_.back());
    missing_.pop_back();
    for (std::size_t i = 0; i < part_.size(); ++i)
      for (std::size_t m = 0; m < missing_.size();) {
        if (!hang_together(part_[i], missing_[m])) {
          ++m;
          continue;
        }
        part_.push_back(missing_[m]);
        missing_.erase(missing_.begin() + static_cast<std::ptrdiff_t>(m));
      }
  }

  /// Two subfaces with a common side, which is no edge of the complex: an edge would part their cavities.
  bool hang_together(const Face& a, const Face& b) {
    VertexIndex common[3];
    std::size_t n = 0;
    for (const VertexIndex v : a)
      if (std::find(b.begin(), b.end(), v) != b.end()) common[n++] = v;
    return n == 2 && c_.find_edge(common[0], common[1], scratch_) == kNoIndex;
  }

  /// The tet around edge (u, v), if that is there, which the subface (u, v, w) enters.
  TetIndex find_cut_tet(VertexIndex u, VertexIndex v, VertexIndex w) {
    const TetIndex at = c_.find_edge(u, v, scratch_);
    if (at == kNoIndex) return kNoIndex;
    c_.edge_ring(at, u, v, scratch_);
    for (const TetIndex t : scratch_) {
      if (c_.is_ghost(t)) continue;
      VertexIndex other[2];
      std::size_t n = 0;
      for (unsigned k = 0; k < 4; ++k)
        if (const VertexIndex x = c_.node[4 * t + k]; x != u && x != v) other[n++] = x;
      if (c_.orient(u, v, other[0], other[1]) < 0) std::swap(other[0], other[1]);
      if (c_.orient(u, v, other[0], w) > 0 && c_.orient(u, v, w, other[1]) > 0) return t;
    }
    return kNoIndex;
  }

  /// All tets that the part cuts, by the edges that cross it; fails at ghosts and at constrained faces that cross it.
  bool collect_cavity(TetIndex start) {
    cavity_.assign(1, start);
    c_.flag[start] |= TetComplex::marked;
    sides_.clear();
    for (const VertexIndex v : outline_) sides_[v] = 0;
    crossing_.clear();
    for (std::size_t i = 0; i < cavity_.size(); ++i) {
      const TetIndex t = cavity_[i];
      for (const auto& edge : kEdgeNodes) {
        const VertexIndex x = c_.node[4 * t + edge[0]], y = c_.node[4 * t + edge[1]];
        if (cached_side(x) * cached_side(y) >= 0) continue;
        if (!crossing_.insert({std::min(x, y), std::max(x, y)}).second) continue;
        c_.edge_ring(t, x, y, ring_);
        for (const TetIndex r : ring_) {
          if (c_.is_ghost(r)) return false;
          if (c_.flag[r] & TetComplex::marked) continue;
          c_.flag[r] |= TetComplex::marked;
          cavity_.push_back(r);
        }
      }
    }
    return sort_cavity_faces();
  }

  int cached_side(VertexIndex v) {
    const auto [it, is_new] = sides_.try_emplace(v, 0);
    if (is_new) it->second = side(v);
    return it->second;
  }

  bool sort_cavity_faces() {
    upper_.clear();
    lower_.clear();
    inner_constrained_.clear();
    for (const TetIndex t : cavity_)
      for (unsigned f = 0; f < 4; ++f) {
        const FaceRef ref = 4 * t + f;
        const bool is_inner = c_.flag[c_.neigh[ref] >> 2] & TetComplex::marked;
        if (is_inner && !c_.is_constrained(ref)) continue;
        const Face face = c_.face_nodes(ref);
        int low = 0, high = 0;
        for (const VertexIndex v : face) {
          low = std::min(low, cached_side(v));
          high = std::max(high, cached_side(v));
        }
        if (low < 0 && high > 0) return false;
        if (low == 0 && high == 0) return false;
        (high > 0 ? upper_ : lower_).push_back(face);
        if (is_inner) inner_constrained_.push_back(face);
      }
    return true;
  }

  /// Fills what is above (+1) or below (-1) the part; appends the tets.
  bool fill_half(int which, std::vector<std::array<VertexIndex, 4>>& made) {
    std::vector<Face> faces = which > 0 ? upper_ : lower_;
    for (const Face& f : part_) faces.push_back(which > 0 ? f : Face{f[0], f[2], f[1]});
    local_.clear();
    global_.clear();
    points_.clear();
    for (const TetIndex t : cavity_)
      for (unsigned k = 0; k < 4; ++k)
        if (const VertexIndex v = c_.node[4 * t + k]; cached_side(v) * which > 0) local_index(v);
    std::vector<std::array<std::uint32_t, 3>> local_faces;
    for (const Face& f : faces) local_faces.push_back({local_index(f[0]), local_index(f[1]), local_index(f[2])});
    std::vector<std::array<std::uint32_t, 4>> tets;
    if (!fill_polyhedron(points_, local_faces, tets)) return fill_from_point(which, faces, made);
    for (const auto& t : tets) made.push_back({global_[t[0]], global_[t[1]], global_[t[2]], global_[t[3]]});
    return true;
  }

  /// Where no tetrahedrization was found without one: a point that sees the whole half, if there is one.
  bool fill_from_point(int which, const std::vector<Face>& faces, std::vector<std::array<VertexIndex, 4>>& made) {
    std::vector<Wall> walls;
    Point start, middle;
    double reach = 0;
    for (const Face& f : faces) {
      walls.push_back({c_.exact(f[0]), c_.exact(f[1]), c_.exact(f[2])});
      for (const VertexIndex v : f) middle = middle + c_.point(v) / (3.0 * static_cast<double>(faces.size()));
    }
    for (const Face& f : part_)
      for (const VertexIndex v : f) start = start + c_.point(v) / (3.0 * static_cast<double>(part_.size()));
    for (const Face& f : faces) reach = std::max(reach, distance(start, c_.point(f[0])));
    const Point normal = static_cast<double>(which) * cross(c_.point(corner_[1]) - c_.point(corner_[0]),
                                                            c_.point(corner_[2]) - c_.point(corner_[0]));
    const auto place = find_visible_point(walls, start, {normal, middle - start}, reach);
    if (!place) return false;
    std::set<VertexIndex> on_walls;
    for (const Face& f : faces) on_walls.insert(f.begin(), f.end());
    if (on_walls.size() < global_.size()) return false;  // a vertex inside would be lost
    const VertexIndex v = c_.add_vertex(*place, c_.vertex[corner_[0]].h);
    for (const Face& f : faces) made.push_back({f[0], f[1], f[2], v});
    return true;
  }

  /// Every face of the hole belongs to one new tet, every other face to two.
  bool closes(const std::vector<std::array<VertexIndex, 4>>& made) {
    std::map<Face, int> missing;  // how many tets a face still lacks
    for (const TetIndex t : cavity_)
      for (unsigned f = 0; f < 4; ++f)
        if (!(c_.flag[c_.neigh[4 * t + f] >> 2] & TetComplex::marked)) missing[sorted(c_.face_nodes(4 * t + f))] = 1;
    for (const auto& tet : made)
      for (const auto& f : kFaceNodes) {
        const auto [at, is_inner] = missing.try_emplace(sorted({tet[f[0]], tet[f[1]], tet[f[2]]}), 2);
        if (--at->second < 0) return false;
      }
    return std::all_of(missing.begin(), missing.end(), [](const auto& m) { return m.second == 0; });
  }

  bool loses_required_edge(const std::vector<std::array<VertexIndex, 4>>& made) {
    std::set<std::array<VertexIndex, 2>> have;
    auto edge_of = [](const VertexIndex* node, int e) {
      const VertexIndex a = node[kEdgeNodes[e][0]], b = node[kEdgeNodes[e][1]];
      return std::array{std::min(a, b), std::max(a, b)};
    };
    for (const auto& tet : made)
      for (int e = 0; e < 6; ++e) have.insert(edge_of(tet.data(), e));
    for (const TetIndex t : cavity_)
      for (int e = 0; e < 6; ++e)
        if (const auto edge = edge_of(&c_.node[4 * t], e); required_.has(edge[0], edge[1]) && !have.contains(edge))
          return true;
    return false;
  }

  std::uint32_t local_index(VertexIndex v) {
    const auto [it, is_new] = local_.try_emplace(v, static_cast<std::uint32_t>(points_.size()));
    if (is_new) {
      points_.push_back(c_.exact(v));
      global_.push_back(v);
    }
    return it->second;
  }

  bool unmark(bool result) {
    for (const TetIndex t : cavity_) c_.flag[t] &= static_cast<std::uint16_t>(~TetComplex::marked);
    return result;
  }

  TetComplex& c_;
  const Model& model_;
  const Segments& segments_;
  const EdgeSet& required_;
  Face corner_{};
  VertexIndex apex_ = kNoIndex;
  std::vector<VertexIndex> outline_, along_, global_;
  std::vector<Face> subfaces_, missing_, part_, upper_, lower_, inner_constrained_;
  std::vector<TetIndex> scratch_, ring_, cavity_, new_tets_;
  std::unordered_map<VertexIndex, int> sides_;
  std::unordered_map<VertexIndex, std::uint32_t> local_;
  std::vector<ExactPoint> points_;
  std::set<std::array<VertexIndex, 2>> crossing_;
  std::set<Face> keep_;
};

}  // namespace

std::vector<TriangleId> recover_facets(TetComplex& complex, const Model& model, const Segments& segments,
                                       const EdgeSet& required, std::vector<Subface>& subfaces,
                                       std::size_t& num_missing, Context& context) {
  FacetRecovery recovery(complex, model, segments, required);
  std::vector<TriangleId> failed;
  for (std::size_t t = 0; t < model.triangles.size(); ++t) {
    if (!recovery.recover(TriangleId(t))) failed.push_back(TriangleId(t));
    for (const Face& f : recovery.subfaces()) subfaces.push_back({f, TriangleId(t)});
    if (t % 512 == 0) context.progress("recover", t, model.triangles.size(), "faces");
  }
  num_missing = recovery.num_missing;
  return failed;
}

}  // namespace delfront
