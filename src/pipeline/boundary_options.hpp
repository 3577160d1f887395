// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "pipeline/option_table.hpp"

namespace delfront {

/// @brief [boundaries.NAME], for the option table.
EntryTable boundary_table();

}  // namespace delfront
