// SPDX-License-Identifier: Apache-2.0
// Gmsh's parsed views (.pos): View "name" { SS(x,y,z, …){v, …}; … }; with S, V or T for one, three or nine components
// and P, L, T, Q, S, H, I, Y for the cell. Every cell names its own places: equal ones become one node, whose value is
// the mean. Of several time steps the first is read. Files that begin with $MeshFormat are read as MSH.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <unordered_map>

#include "delfront/errors.hpp"
#include "io/cells.hpp"
#include "io/cursor.hpp"
#include "io/formats.hpp"
#include "io/node_means.hpp"

namespace delfront {

namespace {

constexpr std::size_t kCheckEvery = std::size_t{1} << 14;

std::optional<CellType> type_of(char letter) {
  switch (letter) {
    case 'P':
      return CellType::vertex;
    case 'L':
      return CellType::line;
    case 'T':
      return CellType::triangle;
    case 'Q':
      return CellType::quad;
    case 'S':
      return CellType::tetrahedron;
    case 'H':
      return CellType::hexahedron;
    case 'I':
      return CellType::prism;
    case 'Y':
      return CellType::pyramid;
    default:
      return std::nullopt;
  }
}

int components_of(char letter) { return letter == 'S' ? 1 : letter == 'V' ? 3 : letter == 'T' ? 9 : 0; }

/// Words, numbers and signs of the text.
class Scanner {
 public:
  Scanner(std::string_view bytes, const std::string& path) : bytes_(bytes), cursor_(bytes, path) {}

  char peek() {
    skip_blanks();
    return at_ < bytes_.size() ? bytes_[at_] : '\0';
  }
  bool at_end() { return peek() == '\0' && at_ >= bytes_.size(); }
  bool take(char c) {
    if (peek() != c) return false;
    ++at_;
    return true;
  }
  void expect(char c) {
    if (!take(c))
      fail(fmt::format("'{}' should stand here{}", c, at_ < bytes_.size() ? "" : "; the file is truncated"));
  }
  std::string_view word() {
    skip_blanks();
    const std::size_t begin = at_;
    while (at_ < bytes_.size() && is_word(bytes_[at_])) ++at_;
    return bytes_.substr(begin, at_ - begin);
  }
  std::string string() {
    expect('"');
    const std::size_t end = bytes_.find('"', at_);
    if (end == std::string_view::npos) fail("a name in quotes that does not end");
    const std::string text(bytes_.substr(at_, end - at_));
    at_ = end + 1;
    return text;
  }
  double number() {
    skip_blanks();
    const std::size_t begin = at_;
    while (at_ < bytes_.size() &&
           (is_word(bytes_[at_]) || bytes_[at_] == '+' || bytes_[at_] == '-' || bytes_[at_] == '.'))
      ++at_;
    double value = 0;
    const std::string_view token = bytes_.substr(begin, at_ - begin);
    if (!parse_number(token, value)) {
      at_ = begin;
      fail(fmt::format("'{}' where a number should stand", token.substr(0, 40)));
    }
    return value;
  }
  /// @brief Numbers with commas between them up to the closing sign.
  void numbers(char open, char close, std::vector<double>& into) {
    into.clear();
    expect(open);
    if (take(close)) return;
    do into.push_back(number());
    while (take(','));
    expect(close);
  }
  void skip_to(char c) {
    while (at_ < bytes_.size() && bytes_[at_] != c) ++at_;
    expect(c);
  }
  [[noreturn]] void fail(const std::string& message) const { cursor_.fail_at(at_, message); }

 private:
  static bool is_word(char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  }
  void skip_blanks() {
    while (at_ < bytes_.size()) {
      const std::string_view rest = bytes_.substr(at_);
      if (rest[0] == ' ' || rest[0] == '\t' || rest[0] == '\n' || rest[0] == '\r') {
        ++at_;
      } else if (rest.starts_with("//")) {
        at_ = std::min(bytes_.find('\n', at_), bytes_.size());
      } else if (rest.starts_with("/*")) {
        const std::size_t end = bytes_.find("*/", at_ + 2);
        at_ = end == std::string_view::npos ? bytes_.size() : end + 2;
      } else {
        return;
      }
    }
  }

  std::string_view bytes_;
  Cursor cursor_;
  std::size_t at_ = 0;
};

struct PointHash {
  std::size_t operator()(const Point& p) const {
    std::size_t hash = 0;
    for (double value : {p.x, p.y, p.z}) hash = hash * 0x9e3779b97f4a7c15ull + std::hash<double>()(value);
    return hash;
  }
};

class PosReader {
 public:
  PosReader(std::string_view bytes, const std::string& path, Context& context)
      : text_(bytes, path), path_(path), num_bytes_(bytes.size()), context_(context) {}

  Mesh read() {
    while (!text_.at_end()) {
      const std::string_view word = text_.word();
      if (word != "View") text_.fail(fmt::format("'{}' where View should stand", word.substr(0, 40)));
      read_view();
    }
    if (mesh_.top_dimension() < 0)
      throw InputError(fmt::format("{}: the file has no view with cells; save it as a parsed view", path_));
    check_finite(mesh_, path_);
    guess_dimension(mesh_);
    add_fields();
    return std::move(mesh_);
  }

 private:
  /// The values of one view with one number of components, each with its node.
  struct Values {
    std::string name;
    int components;
    std::vector<VertexId> nodes;
    std::vector<double> values;
  };

  void read_view() {
    const std::string name = text_.string();
    text_.expect('{');
    const std::size_t first = values_.size();
    while (!text_.take('}')) {
      if (++num_items_ % kCheckEvery == 0) context_.check_limits();
      const std::string word(text_.word());
      const auto type = word.size() == 2 ? type_of(word[1]) : std::nullopt;
      const int components = word.empty() ? 0 : components_of(word[0]);
      if (word == "TIME" || word == "INTERPOLATION_SCHEME" || word == "T2" || word == "T3") {
        text_.skip_to(';');
      } else if (type && components > 0) {
        read_cell(*type, view_values(first, name, components));
      } else {
        text_.fail(
            fmt::format("'{}' is none of SP, SL, ST, SQ, SS, SH, SI, SY (or with V or T for S); save linear cells",
                        word.substr(0, 40)));
      }
    }
    text_.take(';');
    is_first_view_ = false;
  }

  Values& view_values(std::size_t first, const std::string& name, int components) {
    for (std::size_t i = first; i < values_.size(); ++i)
      if (values_[i].components == components) return values_[i];
    const std::string suffix = values_.size() > first ? fmt::format("_{}", components) : "";
    values_.push_back({name + suffix, components, {}, {}});
    return values_.back();
  }

  void read_cell(CellType type, Values& into) {
    text_.numbers('(', ')', numbers_);
    const auto corners = static_cast<std::size_t>(num_vertices(type));
    if (numbers_.size() != 3 * corners)
      text_.fail(fmt::format("{} coordinates for a {} of {} corners", numbers_.size(), name_of(type), corners));
    corners_.clear();
    for (std::size_t k = 0; k < corners; ++k)
      corners_.push_back(node({numbers_[3 * k], numbers_[3 * k + 1], numbers_[3 * k + 2]}));
    text_.numbers('{', '}', numbers_);
    text_.expect(';');
    const std::size_t wanted = corners * static_cast<std::size_t>(into.components);
    if (numbers_.empty() || numbers_.size() % wanted != 0)
      text_.fail(fmt::format("{} values for a {} of {} corners with {} each", numbers_.size(), name_of(type), corners,
                             into.components));
    if (numbers_.size() > wanted && !has_steps_) {
      has_steps_ = true;
      context_.warn(fmt::format("{}: the views have several time steps; the first is read", path_));
    }
    into.nodes.insert(into.nodes.end(), corners_.begin(), corners_.end());
    into.values.insert(into.values.end(), numbers_.begin(), numbers_.begin() + static_cast<std::ptrdiff_t>(wanted));
    if (is_new_cell(type)) add_cell(mesh_, type, corners_, GroupId());
  }

  VertexId node(Point p) {
    for (int k = 0; k < 3; ++k) p[k] += 0.0;  // -0 is 0
    const auto [found, is_new] = node_at_.try_emplace(p, mesh_.points.next_id());
    if (is_new) mesh_.points.push_back(p);
    return found->second;
  }

  /// Later views repeat the cells of the first.
  bool is_new_cell(CellType type) {
    if (is_first_view_) return true;
    if (known_cells_.empty())
      for (const CellBlock& block : mesh_.blocks)
        for (std::size_t cell = 0; cell < block.size(); ++cell) known_cells_.insert(key_of(block.type, block[cell]));
    return known_cells_.insert(key_of(type, corners_)).second;
  }

  static std::vector<std::uint32_t> key_of(CellType type, std::span<const VertexId> corners) {
    std::vector<std::uint32_t> key;
    for (VertexId v : corners) key.push_back(v.value);
    std::sort(key.begin(), key.end());
    key.push_back(static_cast<std::uint32_t>(type));
    return key;
  }

  void add_fields() {
    std::size_t total = 0;
    for (Values& view : values_) {
      total += mesh_.points.size() * static_cast<std::size_t>(view.components);
      if (total > num_bytes_)
        throw InputError(
            fmt::format("{}: its views have few places in common; save them in files of their own", path_));
      NodeMeans means(mesh_.points.size(), view.components);
      for (std::size_t i = 0; i < view.nodes.size(); ++i)
        means.add(view.nodes[i].index(), view.values.data() + i * static_cast<std::size_t>(view.components));
      if (means.differ())
        context_.warn(
            fmt::format("{}: the cells of '{}' differ at the nodes they share; the mean is taken", path_, view.name));
      mesh_.fields.push_back(means.take(view.name));
    }
  }

  Scanner text_;
  std::string path_;
  std::size_t num_bytes_, num_items_ = 0;
  Context& context_;
  Mesh mesh_;
  std::vector<Values> values_;
  std::vector<double> numbers_;
  std::vector<VertexId> corners_;
  std::unordered_map<Point, VertexId, PointHash> node_at_;
  std::set<std::vector<std::uint32_t>> known_cells_;
  bool is_first_view_ = true, has_steps_ = false;
};

}  // namespace

Mesh read_pos(std::string_view bytes, const std::string& path, Context& context) {
  const std::string_view begin = trimmed(bytes.substr(0, 200));
  if (begin.starts_with("$MeshFormat")) return read_msh(bytes, path, context);
  if (begin.starts_with("$PostFormat"))
    throw InputError(fmt::format(
        "{}: Gmsh's old list format ($PostFormat) is not read; save a parsed view (PostProcessing.Format = 2) or MSH",
        path));
  return PosReader(bytes, path, context).read();
}

}  // namespace delfront
