// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <string_view>

namespace delfront {

/// @brief The known name that somebody who typed `wrong` most likely meant, for "did you mean".
///
/// Compared by edit distance (insert, delete, replace, swap of neighbours; case and '-' against '_' cost nothing), at
/// most a third of the longer name's length; a known name that begins with `wrong` (three letters or more) counts as
/// near too. The first of equally near names is taken.
/// @return "" where no known name is near
std::string nearest_name(std::string_view wrong, std::span<const std::string> known);

}  // namespace delfront
