// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <string>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/findings.hpp"
#include "delfront/mesh.hpp"

namespace delfront {

/// @brief Is it a grid at all? Exact: indices, repeated vertices, positive cells, conformity, boundary faces stored,
/// closed boundary, lines that are edges of cells, unused and doubled points.
/// @return empty for a valid grid
std::vector<Finding> check(const Mesh& mesh);

/// @brief min, max, mean and a histogram of one measure over all cells (or faces), with the worst places.
struct Measure {
  std::string name;  ///< key usable in gates: "min_dihedral", "max_nonortho", …
  std::string unit;  ///< "deg" or ""
  double min = 0, max = 0, mean = 0;
  bool worst_is_low = true;
  std::vector<std::size_t> histogram;  ///< equal bins over [histogram_low, histogram_high]
  double histogram_low = 0, histogram_high = 0;
  std::vector<Place> worst;  ///< the worst first: ids[0] is the cell (or the two cells of a face), `at` its centroid
  std::vector<double> worst_values;
};

/// @brief Quality of a grid; angles in degrees.
struct QualityReport {
  std::size_t num_points = 0, num_cells = 0, num_boundary_faces = 0;
  double volume = 0;
  /// dihedral (per cell its smallest), max_dihedral, mean_ratio, radius_ratio, nonortho and skewness (as OpenFOAM's
  /// checkMesh defines them), volume_ratio (between face neighbours), edge_length, aspect_ratio
  std::vector<Measure> measures;
  std::size_t cells_below_5_deg = 0, cells_below_10_deg = 0;
  const Measure* find(const std::string& name) const;
};

/// @brief How the sides of a grid's cells compare with the sizes that were wanted where they are.
struct SizeFit {
  Measure ratio;           ///< every edge once: its length over the size wanted at its middle; ids: its two points
  double share_right = 0;  ///< of all edges, those of 0.7 to 1.4 times that size
};

/// @param num_worst  how many of the worst each measure lists
QualityReport measure_quality(const Mesh& mesh, Context& context, std::size_t num_worst = 10);

/// @brief A gate such as "min_dihedral > 8, max_nonortho < 70".
/// @return the gates that are not met, as sentences
/// @throws UsageError  an unknown measure (with the nearest right name) or a malformed gate
std::vector<std::string> failed_gates(const QualityReport& report, const std::string& gates);

/// @brief The cells, faces and edges that keep gates from being met: one finding a gate, kind "gate_<measure>".
///
/// Ids and outlines are those of cells (all their faces), of the two cells of a face, or of the two points of an edge;
/// the worst first, at most kMaxPlaces. A gate on the number of cells has no places, nor has one that the measure's
/// good side fails ("min_dihedral < 5").
/// @throws UsageError  as failed_gates
/// @par Cost  that of measure_quality
std::vector<Finding> find_gate_failures(const Mesh& mesh, const std::string& gates, Context& context);

}  // namespace delfront
