// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include "delfront/errors.hpp"
#include "delfront/io.hpp"
#include "fmt/format.h"
#include "io/source.hpp"
#include "io/xml.hpp"
#include "view/page_data.hpp"

namespace delfront {

namespace {

[[noreturn]] void fail_no_defects(const std::string& path, const std::string& lack) {
  throw InputError(fmt::format("{}: is no file of defects ({}); delfront check FILE --defects {} writes one", path,
                               lack, "defects.vtp"));
}

/// kind_id -> its name, from the arrays "kind:<name>" of the field data.
std::map<int, std::string> read_kinds(const std::string& path) {
  const FileBytes bytes(path);
  const XmlElement file = parse_xml(bytes.view(), path);
  std::map<int, std::string> kinds;
  const XmlElement* data = file.child("PolyData");
  const XmlElement* names = data ? data->child("FieldData") : nullptr;
  if (!data) fail_no_defects(path, "not VTP");
  if (!names) return kinds;
  for (const XmlElement& array : names->children) {
    const std::string name = array.get("Name");
    const std::size_t begin = array.text.find_first_not_of(" \n\t\r");
    int id = 0;
    if (!name.starts_with("kind:") || begin == std::string_view::npos) continue;
    std::from_chars(array.text.data() + begin, array.text.data() + array.text.size(), id);
    kinds[id] = name.substr(5);
  }
  return kinds;
}

class DefectReader {
 public:
  DefectReader(const std::string& path, Context& context)
      : path_(path), kinds_(read_kinds(path)), mesh_(read_mesh(path, context)) {}

  std::vector<Finding> read() {
    if (kinds_.empty() && mesh_.points.empty()) return {};  // of a file without defects
    const Field &kind = field("kind_id"), &severity = field("severity"), &finding = field("finding"),
                &id = field("first_id");
    std::map<int, Finding> findings;
    for (const CellBlock& block : mesh_.blocks)
      for (std::size_t cell = 0; cell < block.size(); ++cell) {
        const std::span<const VertexId> corners = block[cell];
        const std::size_t v = corners[0].index();  // each cell has points of its own, with its values
        Finding& into = findings[static_cast<int>(finding.values[v])];
        const auto name = kinds_.find(static_cast<int>(kind.values[v]));
        into.kind = name == kinds_.end() ? "defect" : name->second;
        into.severity = static_cast<Severity>(std::clamp(static_cast<int>(severity.values[v]), 0, 2));
        add_cell(corners, id.values[v], into);
      }
    std::vector<Finding> result;
    for (auto& [index, it] : findings) {
      // the file does not say how many: a hole is one place, but as many edges as it has
      const auto num_edges = static_cast<std::size_t>(std::count_if(
          it.outlines.begin(), it.outlines.end(), [](const Outline& o) { return o.corners.size() == 2; }));
      it.count = std::max({it.places.size(), num_edges, std::size_t{1}});
      result.push_back(std::move(it));
    }
    return result;
  }

 private:
  const Field& field(const std::string& name) const {
    for (const Field& f : mesh_.fields)
      if (f.name == name && f.on == Field::On::vertices && f.components == 1) return f;
    fail_no_defects(path_, fmt::format("the point array '{}' is missing", name));
  }

  void add_cell(std::span<const VertexId> corners, double id, Finding& into) const {
    std::vector<std::uint32_t> ids;
    if (id >= 0) ids.push_back(static_cast<std::uint32_t>(id));
    if (corners.size() == 1) return into.places.push_back({mesh_.points[corners[0]], ids});
    Outline outline{ids.empty() ? 0 : ids[0], {}};
    for (const VertexId v : corners) outline.corners.push_back(mesh_.points[v]);
    into.outlines.push_back(std::move(outline));
  }

  std::string path_;
  std::map<int, std::string> kinds_;
  Mesh mesh_;
};

}  // namespace

std::vector<Finding> read_defects(const std::string& path, Context& context) {
  return DefectReader(path, context).read();
}

}  // namespace delfront
