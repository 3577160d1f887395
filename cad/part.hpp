// SPDX-License-Identifier: Apache-2.0
// What is read and mended before it is translated: a shape, and what is known of its faces.
#pragma once
#include <Message_ProgressRange.hxx>
#include <TopTools_DataMapOfShapeInteger.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "cad/cad_data.hpp"

namespace delfront::cad {

/// @brief What stops reading, with a sentence for the user.
struct Failure : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// @brief The caller wants no more.
struct Stopped {};

/// @brief What a file says of a face.
struct FaceFacts {
  std::string name, colour, layer;
  std::vector<std::string> solids;
};

/// @brief What is known of faces, or of solids, by their shape without orientation; follows them through operations.
class FactTable {
 public:
  explicit FactTable(TopAbs_ShapeEnum kind) : kind_(kind) {}
  void set(const TopoDS_Shape& shape, const FaceFacts& facts);
  const FaceFacts* find(const TopoDS_Shape& shape) const;
  /// @brief The place of a shape in the order they came, which operations keep; -1: it is not there.
  int rank(const TopoDS_Shape& shape) const;
  /// @param images  what became of a shape; empty: it is gone, or unchanged where it is still there
  void follow(const TopoDS_Shape& after, const std::function<TopTools_ListOfShape(const TopoDS_Shape&)>& images);

 private:
  static void merge(FaceFacts& into, const FaceFacts& from);
  TopAbs_ShapeEnum kind_;
  TopTools_DataMapOfShapeInteger index_;
  std::vector<FaceFacts> facts_;
  std::vector<TopoDS_Shape> shapes_;  ///< in the order they came: that of the map is one of addresses
};

/// @brief A file's geometry on its way to the caller.
struct Part {
  TopoDS_Shape shape;
  FactTable faces{TopAbs_FACE};
  FactTable solids{TopAbs_SOLID};  ///< all of them; names in FaceFacts::solids
  CadReport report;
  double diagonal = 0;  ///< of the box round it

  /// @brief A new shape, and what became of faces and solids on the way.
  void become(const TopoDS_Shape& after, const std::function<TopTools_ListOfShape(const TopoDS_Shape&)>& images);
  /// @brief The same, so many times as large.
  void scale(double factor);
};

/// @brief A sentence of progress; throws Stopped where the caller says so.
using Say = std::function<void(const char* what, double fraction)>;

/// @throws Failure  not readable
Part read_file(const std::string& path, const Say& say);

/// @brief Mends what is not valid, sews loose faces, closes shells to solids. Notes all it does.
void heal(Part& part, const CadOptions& options, const Say& say);

/// @throws Failure  an edge ends far from its corner, not by tolerance
void check_corners(const Part& part);
void note_loose_edges(Part& part);

// Parts of mending. Each notes what it does.
/// @brief Edges within the tolerance of their own ends become one corner.
void remove_tiny_edges(Part& part);
/// @brief Parameter curves that lie far from their edges are forgotten; they are found again by projection.
void drop_wrong_parameter_curves(Part& part);
/// @brief Of faces that a shell has twice one stays.
void drop_double_faces(Part& part);
/// @brief Solids with everything but their inside in them.
void turn_inverted_solids(Part& part);

struct Translation;
/// @brief What several solids share becomes the same face of each.
/// @return the part as plain data
Translation join(Part& part, const Say& say);

/// @brief A range that asks the caller whether to go on, for OpenCASCADE's long loops.
class Watch {
 public:
  explicit Watch(const Say& say, const char* what);
  ~Watch();
  Message_ProgressRange range();
  /// @throws Stopped  the caller said so during the operation
  void check() const;

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

std::size_t count_free_edges(const TopoDS_Shape& shape);
double diagonal_of(const TopoDS_Shape& shape);
double largest_tolerance(const TopoDS_Shape& shape);

}  // namespace delfront::cad
