// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "delfront/mesh.hpp"

namespace delfront {

/// @brief The report of a run as one page of HTML: needs no other file, no network and no script; light or dark as the
/// reader's screen is, and printable. What the run ended with comes first, then what is wrong, quality with the worst
/// cells drawn, boundaries, times, options.
/// @param json      the report as docs/report.schema.json describes it, of jobs or of `refine`; valid JSON
/// @param defaults  options that nobody set, as JSON: others are shown first; empty: not known
/// @param mesh      the finished grid, from which cells are drawn; may be empty
/// @return the same bytes for the same report, in UTF-8
std::string report_page(std::string_view json, std::string_view defaults, const Mesh& mesh);

}  // namespace delfront
