// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace delfront {

/// @brief The page as it was built from viewer/; empty where the program was built without it.
std::string_view built_page();

/// @brief The page, or a sentence about what is missing and what to do instead.
/// @throws UsageError  the program was built without the page
std::string_view page_or_throw();

/// @brief The page with its data inside: one file that needs no server and no network.
/// @param data  of make_page_data(); compressed here
std::string make_export(std::string_view page, const std::string& data);

}  // namespace delfront
