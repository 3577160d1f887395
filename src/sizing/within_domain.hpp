// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>

#include "delfront/size_field.hpp"

namespace delfront {

/// @brief The same field, which beyond a box answers as at the nearest place of it: gridding looks at places outside of
/// the domain before it refuses them, where a formula or a function need not have a size.
std::shared_ptr<const SizeField> ask_within(std::shared_ptr<const SizeField> field, const Box& domain);

}  // namespace delfront
