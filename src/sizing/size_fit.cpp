// SPDX-License-Identifier: Apache-2.0
// Edges come bin by bin (FacetSweep); bins are cut into tasks that depend on the grid only, and their tallies are
// merged in order, so that the sums are the same for any number of threads.
#include "sizing/size_fit.hpp"

#include <algorithm>
#include <array>

#include "base/parallel.hpp"
#include "mesh/facet_table.hpp"

namespace delfront {

namespace {

constexpr double kHigh = 3;                ///< upper end of the histogram
constexpr std::size_t kBins = 30;          ///< of it
constexpr double kLow = 0.7, kMost = 1.4;  ///< sides that are as wanted
constexpr std::size_t kWorst = 10, kTasks = 64;

struct LongEdge {
  double ratio;
  FacetSweep::Edge edge;
};

bool is_worse(const LongEdge& a, const LongEdge& b) { return a.ratio != b.ratio ? a.ratio > b.ratio : a.edge < b.edge; }

struct FitTally {
  std::size_t count = 0, right = 0;
  double sum = 0, least = 0, most = 0;
  std::array<std::size_t, kBins> bins{};
  std::vector<LongEdge> worst;

  void add(double ratio, FacetSweep::Edge edge) {
    least = count == 0 ? ratio : std::min(least, ratio);
    most = count == 0 ? ratio : std::max(most, ratio);
    ++count;
    sum += ratio;
    right += ratio >= kLow && ratio <= kMost;
    ++bins[std::min(static_cast<std::size_t>(std::clamp(ratio, 0.0, kHigh) / kHigh * kBins), kBins - 1)];
    keep({ratio, edge});
  }

  void keep(const LongEdge& edge) {
    if (worst.size() == kWorst && !is_worse(edge, worst.back())) return;
    worst.insert(std::upper_bound(worst.begin(), worst.end(), edge, is_worse), edge);
    if (worst.size() > kWorst) worst.pop_back();
  }

  void merge(const FitTally& other) {
    if (other.count == 0) return;
    least = count == 0 ? other.least : std::min(least, other.least);
    most = count == 0 ? other.most : std::max(most, other.most);
    count += other.count;
    right += other.right;
    sum += other.sum;
    for (std::size_t i = 0; i < kBins; ++i) bins[i] += other.bins[i];
    for (const LongEdge& edge : other.worst) keep(edge);
  }
};

Point middle(const Mesh& mesh, FacetSweep::Edge edge) {
  return 0.5 * (mesh.points[VertexId(edge.first)] + mesh.points[VertexId(edge.second)]);
}

void add_edges(const Mesh& mesh, const SizeField& size, std::span<const FacetSweep::Edge> edges, FitTally& tally) {
  std::vector<Point> at;
  at.reserve(edges.size());
  for (const FacetSweep::Edge& edge : edges) at.push_back(middle(mesh, edge));
  std::vector<double> wanted(at.size());
  size.sizes(at, wanted);
  for (std::size_t i = 0; i < at.size(); ++i) {
    const auto [a, b] = edges[i];
    tally.add(distance(mesh.points[VertexId(a)], mesh.points[VertexId(b)]) / wanted[i], edges[i]);
  }
}

SizeFit report(const Mesh& mesh, const FitTally& tally) {
  SizeFit fit;
  Measure& ratio = fit.ratio;
  ratio.name = "size_ratio";
  ratio.worst_is_low = false;
  ratio.min = tally.least;
  ratio.max = tally.most;
  ratio.histogram.assign(tally.bins.begin(), tally.bins.end());
  ratio.histogram_high = kHigh;
  for (const LongEdge& edge : tally.worst) {
    ratio.worst.push_back({middle(mesh, edge.edge), {edge.edge.first, edge.edge.second}});
    ratio.worst_values.push_back(edge.ratio);
  }
  if (tally.count == 0) return fit;
  ratio.mean = tally.sum / static_cast<double>(tally.count);
  fit.share_right = static_cast<double>(tally.right) / static_cast<double>(tally.count);
  return fit;
}

}  // namespace

SizeFit measure_size_fit(const Mesh& mesh, const SizeField& size, const Context& context) {
  const CellRange cells(mesh, mesh.top_dimension()), none(mesh, -1);
  const FacetSweep sweep(mesh, cells, none, context.threads);
  const std::size_t grain = sweep.num_bins() / kTasks + 1;
  std::vector<FitTally> tallies((sweep.num_bins() + grain - 1) / grain);
  parallel_ranges(context.threads, sweep.num_bins(), grain, [&](std::size_t first, std::size_t last) {
    FacetSweep::Scratch scratch;
    for (std::size_t bin = first; bin < last; ++bin) {
      context.check_limits();
      add_edges(mesh, size, sweep.edges(bin, scratch), tallies[first / grain]);
    }
  });
  FitTally total;
  for (const FitTally& tally : tallies) total.merge(tally);
  return report(mesh, total);
}

}  // namespace delfront
