// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "pipeline/option_table.hpp"

namespace delfront {

/// @brief The keys of [size], for the option table.
void add_size_rows(std::vector<OptionRow>& rows);

/// @brief [[size.source]], [[size.box]], [size.on.NAME].
std::vector<EntryTable> size_entry_tables();

}  // namespace delfront
