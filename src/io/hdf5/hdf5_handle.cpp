// SPDX-License-Identifier: Apache-2.0
#include "io/hdf5/hdf5_handle.hpp"

namespace delfront {

namespace {

std::mutex& turn() {
  static std::mutex one;
  return one;
}

}  // namespace

Hdf5Turn::Hdf5Turn() : lock_(turn()) {
  H5Eget_auto2(H5E_DEFAULT, &print_, &print_data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Hdf5Turn::~Hdf5Turn() { H5Eset_auto2(H5E_DEFAULT, print_, print_data_); }

}  // namespace delfront
