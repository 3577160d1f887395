// SPDX-License-Identifier: Apache-2.0
#include "io/hdf5/hdf5_handle.hpp"

namespace delfront {

namespace {

std::mutex& turn() {
  static std::mutex one;
  return one;
}

/// The library tidies up when the program ends, and falls over there after a file that a full disk cut short. All that
/// is open is closed by then.
void leave_the_end_alone() {
  static const herr_t done = H5dont_atexit();
  (void)done;
}

}  // namespace

Hdf5Turn::Hdf5Turn() : lock_(turn()) {
  leave_the_end_alone();
  H5Eget_auto2(H5E_DEFAULT, &print_, &print_data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Hdf5Turn::~Hdf5Turn() { H5Eset_auto2(H5E_DEFAULT, print_, print_data_); }

}  // namespace delfront
