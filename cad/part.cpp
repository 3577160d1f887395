// SPDX-License-Identifier: Apache-2.0
#include "part.hpp"

#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <Message_ProgressIndicator.hxx>
#include <Message_ProgressScope.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Trsf.hxx>

namespace delfront::cad {

void FactTable::set(const TopoDS_Shape& shape, const FaceFacts& facts) {
  if (const int* known = index_.Seek(shape)) return merge(facts_[std::size_t(*known)], facts);
  index_.Bind(shape, int(facts_.size()));
  facts_.push_back(facts);
  shapes_.push_back(shape);
}

int FactTable::rank(const TopoDS_Shape& shape) const {
  const int* known = index_.Seek(shape);
  return known ? *known : -1;
}

const FaceFacts* FactTable::find(const TopoDS_Shape& shape) const {
  const int known = rank(shape);
  return known < 0 ? nullptr : &facts_[std::size_t(known)];
}

void FactTable::merge(FaceFacts& into, const FaceFacts& from) {
  if (into.name.empty()) into.name = from.name;
  if (into.colour.empty()) into.colour = from.colour;
  if (into.layer.empty()) into.layer = from.layer;
  for (const std::string& solid : from.solids)
    if (std::find(into.solids.begin(), into.solids.end(), solid) == into.solids.end()) into.solids.push_back(solid);
}

void FactTable::follow(const TopoDS_Shape& after,
                       const std::function<TopTools_ListOfShape(const TopoDS_Shape&)>& images) {
  TopTools_IndexedMapOfShape there;
  TopExp::MapShapes(after, kind_, there);
  FactTable next(kind_);
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    const TopTools_ListOfShape made = images(shapes_[i]);
    if (there.Contains(shapes_[i])) next.set(shapes_[i], facts_[i]);
    for (const TopoDS_Shape& image : made)
      for (TopExp_Explorer part(image, kind_); part.More(); part.Next())
        if (!part.Current().IsSame(shapes_[i])) next.set(part.Current(), facts_[i]);
  }
  *this = next;
}

void Part::become(const TopoDS_Shape& after, const std::function<TopTools_ListOfShape(const TopoDS_Shape&)>& images) {
  shape = after;
  faces.follow(shape, images);
  solids.follow(shape, images);
}

void Part::scale(double factor) {
  gp_Trsf larger;
  larger.SetScaleFactor(factor);
  BRepBuilderAPI_Transform transform(shape, larger, true);
  become(transform.Shape(), [&](const TopoDS_Shape& before) { return transform.Modified(before); });
  diagonal *= factor;
}

namespace {

class Indicator : public Message_ProgressIndicator {
 public:
  Indicator(const Say& say, const char* what) : say_(say), what_(what) {}
  bool is_stopped = false;

 protected:
  Standard_Boolean UserBreak() override {
    tell();
    return is_stopped;
  }
  void Show(const Message_ProgressScope&, const Standard_Boolean) override { tell(); }

 private:
  /// An exception of ours must not run through OpenCASCADE's loops.
  void tell() {
    if (is_stopped) return;
    try {
      say_(what_, GetPosition());
    } catch (const Stopped&) {
      is_stopped = true;
    }
  }
  const Say& say_;
  const char* what_;
};

}  // namespace

struct Watch::Inside {
  Handle(Indicator) indicator;
};

Watch::Watch(const Say& say, const char* what) : inside_(std::make_unique<Inside>()) {
  inside_->indicator = new Indicator(say, what);
}
Watch::~Watch() = default;
Message_ProgressRange Watch::range() { return inside_->indicator->Start(); }
void Watch::check() const {
  if (inside_->indicator->is_stopped) throw Stopped();
}

std::size_t count_free_edges(const TopoDS_Shape& shape) {
  TopTools_IndexedDataMapOfShapeListOfShape faces;
  TopExp::MapShapesAndAncestors(shape, TopAbs_EDGE, TopAbs_FACE, faces);
  std::size_t count = 0;
  for (int i = 1; i <= faces.Extent(); ++i) {
    const TopoDS_Edge& edge = TopoDS::Edge(faces.FindKey(i));
    if (BRep_Tool::Degenerated(edge) || faces(i).Extent() != 1) continue;
    if (edge.Orientation() == TopAbs_INTERNAL || edge.Orientation() == TopAbs_EXTERNAL) continue;
    count += !BRep_Tool::IsClosed(edge, TopoDS::Face(faces(i).First()));
  }
  return count;
}

double diagonal_of(const TopoDS_Shape& shape) {
  Bnd_Box box;
  BRepBndLib::Add(shape, box, false);
  return box.IsVoid() || box.IsOpen() ? 0 : std::sqrt(box.SquareExtent());
}

double largest_tolerance(const TopoDS_Shape& shape) {
  double most = 0;
  for (TopExp_Explorer v(shape, TopAbs_VERTEX); v.More(); v.Next())
    most = std::max(most, BRep_Tool::Tolerance(TopoDS::Vertex(v.Current())));
  for (TopExp_Explorer e(shape, TopAbs_EDGE); e.More(); e.Next())
    most = std::max(most, BRep_Tool::Tolerance(TopoDS::Edge(e.Current())));
  return most;
}

}  // namespace delfront::cad
