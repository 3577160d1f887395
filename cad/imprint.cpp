// SPDX-License-Identifier: Apache-2.0
// The general fuse of several solids and sheets: faces that touch are cut by each other, and the common part is one
// face of both. Where solids overlap, what they have in common becomes a solid of its own.
#include <BOPAlgo_Builder.hxx>
#include <BRepBndLib.hxx>
#include <BRepTools_History.hxx>
#include <Bnd_Box.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <algorithm>
#include <vector>

#include "fmt/format.h"
#include "part.hpp"

namespace delfront::cad {
namespace {

/// What is cut by each other: solids, shells of no solid, faces of no shell.
TopTools_IndexedMapOfShape pieces_of(const TopoDS_Shape& shape) {
  TopTools_IndexedMapOfShape pieces;
  TopExp::MapShapes(shape, TopAbs_SOLID, pieces);
  for (TopExp_Explorer it(shape, TopAbs_SHELL, TopAbs_SOLID); it.More(); it.Next()) pieces.Add(it.Current());
  for (TopExp_Explorer it(shape, TopAbs_FACE, TopAbs_SHELL); it.More(); it.Next()) pieces.Add(it.Current());
  return pieces;
}

/// Whether the boxes of two pieces meet, one of which bounds something: sheets beside sheets stay as they are. By
/// sweeping along x.
bool may_touch(const TopTools_IndexedMapOfShape& pieces) {
  struct Piece {
    Bnd_Box box;
    double low = 0, high = 0;
    bool is_closed = false;
  };
  std::vector<Piece> all;
  for (int i = 1; i <= pieces.Extent(); ++i) {
    Piece piece;
    BRepBndLib::Add(pieces(i), piece.box, false);
    if (piece.box.IsVoid()) continue;
    double low_y = 0, low_z = 0, high_y = 0, high_z = 0;
    piece.box.Get(piece.low, low_y, low_z, piece.high, high_y, high_z);
    piece.is_closed = pieces(i).ShapeType() == TopAbs_SOLID || count_free_edges(pieces(i)) == 0;
    all.push_back(piece);
  }
  std::sort(all.begin(), all.end(), [](const Piece& a, const Piece& b) { return a.low < b.low; });
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = i + 1; j < all.size() && all[j].low <= all[i].high; ++j)
      if ((all[i].is_closed || all[j].is_closed) && !all[i].box.IsOut(all[j].box)) return true;
  return false;
}

std::size_t count_faces(const TopoDS_Shape& shape) {
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  return std::size_t(faces.Extent());
}

}  // namespace

void imprint(Part& part, const Say& say) {
  const TopTools_IndexedMapOfShape pieces = pieces_of(part.shape);
  if (pieces.Extent() < 2 || !may_touch(pieces)) return;
  TopTools_IndexedMapOfShape solids;
  TopExp::MapShapes(part.shape, TopAbs_SOLID, solids);
  BOPAlgo_Builder fuse;
  for (int i = 1; i <= pieces.Extent(); ++i) fuse.AddArgument(pieces(i));
  fuse.SetNonDestructive(true);
  fuse.SetRunParallel(false);
  Watch watch(say, "joining solids");
  fuse.Perform(watch.range());
  watch.check();
  if (fuse.HasErrors() || fuse.Shape().IsNull() || count_faces(fuse.Shape()) == 0) {
    part.report.suspicious.push_back(
        {"not_imprinted",
         fmt::format("the {} solids and sheets could not be joined where they touch", pieces.Extent()),
         {}});
    return;
  }
  const std::size_t before = count_faces(part.shape), after = count_faces(fuse.Shape());
  const Handle(BRepTools_History) history = fuse.History();
  part.shape = fuse.Shape();
  part.faces.follow(part.shape, [&](const TopoDS_Shape& face) {
    return history.IsNull() ? TopTools_ListOfShape() : history->Modified(face);
  });
  TopTools_IndexedMapOfShape made;
  TopExp::MapShapes(part.shape, TopAbs_SOLID, made);
  if (before != after || made.Extent() != solids.Extent())
    part.report.repairs.push_back(
        {"imprinted",
         fmt::format("solids and sheets that touch were joined: {} faces became {}, {} solids {}", before, after,
                     solids.Extent(), made.Extent()),
         {}});
}

}  // namespace delfront::cad
