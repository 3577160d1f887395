// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "delfront/context.hpp"
#include "delfront/generate.hpp"
#include "volume/front_store.hpp"

namespace delfront {

/// @brief Close what the sweeps left of the front, a set of small cavities (F17).
///
/// Each is filled by tets to one point in it; where faces do not see that point, or only under bad angles, the tets
/// behind them are emptied and the point is moved, until all do.
/// @return the faces that are left: of cavities at which that came to no end
std::vector<std::uint32_t> fill_cavities(FrontStore& front, const std::vector<std::uint32_t>& faces,
                                         FrontReport& report, Context& context);

/// @brief Take away the tets behind the faces at the corners of what is left, so that it can be gridded anew.
/// @return all faces of the front
std::vector<std::uint32_t> empty_around(FrontStore& front, const std::vector<std::uint32_t>& faces,
                                        FrontReport& report);

/// @brief A place on each cavity, a set of faces that hang together by their corners; those of most faces first.
/// @return no more than kMaxPlaces
std::vector<Place> places_of_cavities(const FrontStore& front, const std::vector<std::uint32_t>& faces);

/// @brief Fill closed cavities by constrained Delaunay with points inside alone (T2).
/// @throws MeshingError  where boundary recovery gives up, or would have to divide faces
void close_by_delaunay(FrontStore& front, const std::vector<std::uint32_t>& faces, FrontReport& report,
                       Context& context);

}  // namespace delfront
