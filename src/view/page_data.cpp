// SPDX-License-Identifier: Apache-2.0
#include "view/page_data.hpp"

#include <bit>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <span>

#include "delfront/grid_check.hpp"
#include "delfront/version.hpp"
#include "pipeline/report_json.hpp"
#include "view/cell_values.hpp"

namespace delfront {

namespace {

using Json = nlohmann::ordered_json;
static_assert(std::endian::native == std::endian::little);

/// The arrays behind the header. Compact ones are stored by planes of bytes (all lowest bytes, then all second ones …),
/// whole numbers as differences first: neighbours are alike, and zlib sees it.
class ArrayWriter {
 public:
  explicit ArrayWriter(bool is_compact) : is_compact_(is_compact) {}

  Json add(std::span<const float> values) {
    std::vector<std::uint32_t> bits(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) bits[i] = std::bit_cast<std::uint32_t>(values[i]);
    return put(bits, "f4", "planes");
  }
  /// Not for places, which keep all their digits.
  Json add_rounded(std::span<const float> values) {
    std::vector<float> rounded(values.begin(), values.end());
    if (is_compact_)
      for (float& value : rounded) value = round_mantissa(value);
    return add(rounded);
  }
  Json add(std::vector<std::uint32_t> values) {
    if (is_compact_) {
      std::uint32_t before = 0;
      for (std::uint32_t& value : values) {
        const std::uint32_t step = value - before;
        before = value;
        value = (step << 1) ^ (0u - (step >> 31));  // small numbers for small steps of either sign
      }
    }
    return put(values, "u4", "differences");
  }
  const std::string& bytes() const { return bytes_; }

 private:
  static float round_mantissa(float value) {
    constexpr std::uint32_t kDropped = 13;
    if (!std::isfinite(value)) return value;
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(value) + (1u << (kDropped - 1));
    return std::bit_cast<float>(bits >> kDropped << kDropped);
  }

  Json put(const std::vector<std::uint32_t>& words, const char* type, const char* filter) {
    const std::size_t begin = bytes_.size(), n = words.size();
    bytes_.resize(begin + 4 * n);
    if (!is_compact_) {
      std::memcpy(bytes_.data() + begin, words.data(), 4 * n);
    } else {
      for (std::size_t plane = 0; plane < 4; ++plane)
        for (std::size_t i = 0; i < n; ++i)
          bytes_[begin + plane * n + i] = static_cast<char>(words[i] >> (8 * plane) & 0xff);
    }
    return {{"type", type}, {"filter", is_compact_ ? filter : "none"}, {"offset", begin}, {"length", n}};
  }

  bool is_compact_;
  std::string bytes_;
};

std::vector<std::uint32_t> ids_of(std::span<const VertexId> ids) {
  std::vector<std::uint32_t> values(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) values[i] = ids[i].value;
  return values;
}

class PageData {
 public:
  PageData(const PageInput& input, bool is_compact, Context& context)
      : input_(input), mesh_(*input.mesh), context_(context), arrays_(is_compact) {}

  std::string make() {
    std::vector<CellValues> values = measure_each_cell(mesh_, context_);  // throws where indices are wrong
    Json header = {{"name", input_.name},
                   {"version", kVersion},
                   {"is_grid", input_.is_grid},
                   {"dimension", mesh_.dimension},
                   {"top_dimension", mesh_.top_dimension()}};
    add_points(header);
    add_groups(header);
    header["blocks"] = Json::array();
    for (const CellBlock& block : mesh_.blocks)
      if (block.size() > 0) header["blocks"].push_back(block_json(block));
    header["measures"] = Json::array();
    for (const CellValues& measure : values) header["measures"].push_back(measure_json(measure));
    header["fields"] = Json::array();
    for (const Field& field : mesh_.fields)
      if (!field.values.empty()) header["fields"].push_back(field_json(field));
    header["findings"] = Json::array();
    for (const Finding& finding : input_.findings) header["findings"].push_back(finding_json(finding));
    return with_header(header.dump(-1, ' ', false, Json::error_handler_t::replace));
  }

 private:
  void add_points(Json& header) {
    Box box;
    for (const Point& p : mesh_.points)
      if (is_finite(p)) box.add(p);
    centre_ = box.is_empty() ? Point{} : box.centre();
    std::vector<float> values;
    values.reserve(3 * mesh_.points.size());
    for (const Point& p : mesh_.points) push_point(is_finite(p) ? p : centre_, values);
    header["centre"] = {centre_.x, centre_.y, centre_.z};
    if (box.is_empty()) box.add(Point{});
    header["box"] = {box.low.x, box.low.y, box.low.z, box.high.x, box.high.y, box.high.z};
    header["points"] = arrays_.add(values);
  }

  void push_point(Point p, std::vector<float>& values) const {
    for (int k = 0; k < 3; ++k) values.push_back(static_cast<float>(p[k] - centre_[k]));
  }

  void add_groups(Json& header) {
    header["groups"] = Json::array();
    for (const Group& g : mesh_.groups)
      header["groups"].push_back(
          {{"name", g.name}, {"dimension", g.dimension}, {"kind", g.kind}, {"two_sided", g.two_sided}});
  }

  Json block_json(const CellBlock& block) {
    std::vector<std::uint32_t> groups(block.size(), GroupId::kNone);
    for (std::size_t i = 0; i < std::min(groups.size(), block.group.size()); ++i) groups[i] = block.group[i].value;
    Json json = {{"type", name_of(block.type)},
                 {"dimension", dimension(block.type)},
                 {"num_cells", block.size()},
                 {"vertices", arrays_.add(ids_of(block.vertices))},
                 {"groups", arrays_.add(std::move(groups))}};
    if (!block.offsets.empty()) {
      std::vector<std::uint32_t> offsets(block.offsets.size());
      for (std::size_t i = 0; i < offsets.size(); ++i) offsets[i] = static_cast<std::uint32_t>(block.offsets[i]);
      json["offsets"] = arrays_.add(std::move(offsets));
    }
    return json;
  }

  Json measure_json(const CellValues& measure) {
    return {{"name", measure.name},
            {"unit", measure.unit},
            {"is_quality", measure.is_quality},
            {"worst_is_low", measure.worst_is_low},
            {"range", {measure.range_low, measure.range_high}},
            {"values", arrays_.add_rounded(measure.values)}};
  }

  Json field_json(const Field& field) {
    std::vector<float> values(field.values.size());
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(field.values[i]);
    return {{"name", field.name},
            {"on", field.on == Field::On::vertices ? "vertices" : "cells"},
            {"block", name_of(field.block)},
            {"components", field.components},
            {"values", arrays_.add_rounded(values)}};
  }

  Json finding_json(const Finding& finding) {
    std::vector<float> at, corners;
    std::vector<std::uint32_t> ids, offsets = {0};
    for (const Place& place : finding.places) {
      if (!is_finite(place.at)) continue;
      push_point(place.at, at);
      ids.push_back(place.ids.empty() ? GroupId::kNone : place.ids[0]);
    }
    for (const Outline& outline : finding.outlines) {
      for (const Point& p : outline.corners) push_point(is_finite(p) ? p : centre_, corners);
      offsets.push_back(static_cast<std::uint32_t>(corners.size() / 3));
    }
    return {{"kind", finding.kind},           {"severity", severity_name(finding.severity)},
            {"count", finding.count},         {"message", finding.message},
            {"remedy", finding.remedy},       {"places", arrays_.add(at)},
            {"ids", arrays_.add(ids)},        {"outlines", arrays_.add(corners)},
            {"offsets", arrays_.add(offsets)}};
  }

  std::string with_header(std::string header) const {
    header.resize((header.size() + 3) / 4 * 4, ' ');
    std::string data("DFVIEW1", 8);
    const std::uint32_t sizes[2] = {static_cast<std::uint32_t>(header.size()), 0};
    data.append(reinterpret_cast<const char*>(sizes), sizeof sizes);
    return data + header + arrays_.bytes();
  }

  const PageInput& input_;
  const Mesh& mesh_;
  Context& context_;
  Point centre_;
  ArrayWriter arrays_;
};

}  // namespace

std::string make_page_data(const PageInput& input, bool is_compact, Context& context) {
  return PageData(input, is_compact, context).make();
}

}  // namespace delfront
