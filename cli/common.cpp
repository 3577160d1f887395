// SPDX-License-Identifier: Apache-2.0
// What the commands share: common flags, tables on stdout.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <thread>

#include "commands.hpp"
#include "delfront/errors.hpp"
#include "delfront/io.hpp"
#include "guard.hpp"
#include "interrupt.hpp"
#include "pipeline/report_json.hpp"

namespace delfront::cli {

void Command::add_common_flags() {
  app->add_option("-j,--threads", common_.threads, "threads; by default all; the grid is the same for any number")
      ->type_name("N")
      ->group("Run");
  app->add_option("--progress", common_.progress, "auto, bar, plain, json (lines on stderr) or none")
      ->type_name("STYLE")
      ->group("Run");
  app->add_flag("-v,--verbose", common_.is_verbose, "say more")->group("Run");
  app->add_flag("-q,--quiet", common_.is_quiet, "say nothing but errors")->group("Run");
}

Terminal Command::make_terminal() const {
  if (common_.threads < 0) throw UsageError(fmt::format("-j {}: expected a number of threads", common_.threads));
  return Terminal(parse_progress_style(common_.progress), common_.is_quiet ? -1 : common_.is_verbose ? 1 : 0);
}

void Command::prepare(Context& context, Terminal& terminal) const {
  const int all = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  context.threads = common_.threads > 0 ? common_.threads : all;
  context.cancel = stop_on_interrupt();
  terminal.attach(context);
  watch_cad_reading(context);
}

std::string format_list() {
  std::string result;
  for (const FormatInfo& format : formats()) {
    const char* can = format.can_read && format.can_write ? "read, write" : format.can_read ? "read" : "write";
    result += fmt::format("  {:<10} {:<16} {:<12} {}\n", format.name,
                          fmt::format("{}", fmt::join(format.extensions, " ")), can, format.title);
  }
  return result;
}

std::string with_commas(std::size_t value) {
  const std::string digits = std::to_string(value);
  std::string result;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) result += ',';
    result += digits[i];
  }
  return result;
}

constexpr std::size_t kMostIds = 8;  // of a place

void print_findings(const std::vector<Finding>& findings, std::size_t places_shown) {
  std::vector<const Finding*> sorted;
  for (const Finding& f : findings) sorted.push_back(&f);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Finding* a, const Finding* b) { return a->severity > b->severity; });
  for (const Finding* f : sorted) {
    fmt::print("{:<8} {:<26} {:>9}  {}\n", severity_name(f->severity), f->kind, with_commas(f->count), f->message);
    for (std::size_t i = 0; i < std::min(places_shown, f->places.size()); ++i) {
      const Place& place = f->places[i];
      const std::size_t shown = std::min(place.ids.size(), kMostIds);
      fmt::print("{:>45}  at ({:.9g}, {:.9g}, {:.9g}), ids {}{}\n", "", place.at.x, place.at.y, place.at.z,
                 fmt::join(place.ids.begin(), place.ids.begin() + static_cast<std::ptrdiff_t>(shown), " "),
                 shown < place.ids.size() ? " …" : "");
    }
    if (!f->remedy.empty()) fmt::print("{:>45}  try: {}\n", "", f->remedy);
  }
}

void print_quality(const QualityReport& report, std::size_t worst_shown) {
  const bool is_planar = !report.find("min_dihedral");
  fmt::print("{:<14} {:.9g}\n", is_planar ? "area" : "volume", report.volume);
  fmt::print("{:<14} {:>11} {:>11} {:>11}\n", "quality", "min", "mean", "max");
  for (const Measure& m : report.measures) {
    fmt::print("  {:<12} {:>11.4g} {:>11.4g} {:>11.4g}{}{}\n", m.name, m.min, m.mean, m.max, m.unit.empty() ? "" : " ",
               m.unit);
    for (std::size_t i = 0; i < std::min({worst_shown, m.worst.size(), m.worst_values.size()}); ++i) {
      const Point at = m.worst[i].at;
      fmt::print("      {:>11.5g}  at ({:.6g}, {:.6g}, {:.6g}), cell {}\n", m.worst_values[i], at.x, at.y, at.z,
                 fmt::join(m.worst[i].ids, " "));
    }
  }
  fmt::print("  cells with {} angle below 5 deg: {}, below 10 deg: {}\n", is_planar ? "an" : "a dihedral",
             with_commas(report.cells_below_5_deg), with_commas(report.cells_below_10_deg));
}

void print_mesh_facts(const Mesh& mesh) {
  fmt::print("points         {}\n", with_commas(mesh.points.size()));
  for (const CellBlock& block : mesh.blocks)
    if (block.size()) fmt::print("{:<14} {}\n", name_of(block.type), with_commas(block.size()));
  std::vector<std::size_t> count(mesh.groups.size());
  for (const CellBlock& block : mesh.blocks)
    for (const GroupId group : block.group)
      if (group.is_valid() && group.index() < count.size()) ++count[group.index()];
  for (const auto& [codimension, title] : {std::pair{0, "regions"}, {1, "patches"}, {2, "curves"}}) {
    const int dim = mesh.dimension - codimension;
    if (dim < 1) continue;
    std::string line;
    for (std::size_t g = 0; g < count.size(); ++g) {
      const Group& group = mesh.groups[GroupId(g)];
      if (group.dimension != dim) continue;
      line += fmt::format("{}{} ({}{}{})", line.empty() ? "" : ", ", group.name, with_commas(count[g]),
                          group.kind.empty() ? "" : ", ", group.kind);
    }
    if (!line.empty()) fmt::print("{:<14} {}\n", title, line);
  }
  const Box box = mesh.bounding_box();
  if (!box.is_empty())
    fmt::print("box            ({:.9g}, {:.9g}, {:.9g}) to ({:.9g}, {:.9g}, {:.9g})\n", box.low.x, box.low.y, box.low.z,
               box.high.x, box.high.y, box.high.z);
}

void write_json(const std::string& path, const std::string& text) {
  if (path == "-")
    fmt::print("{}", text);
  else
    write_text_file(path, text);
}

}  // namespace delfront::cli
