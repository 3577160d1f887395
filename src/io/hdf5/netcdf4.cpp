// SPDX-License-Identifier: Apache-2.0
// netCDF-4: variables are the arrays of the root, dimensions without a variable are arrays too, whose extent is all
// that they say. (A variable that shares its name with a dimension of another meaning has "_nc4_non_coord_" before it.)
#include "io/exodus/netcdf.hpp"
#include "io/hdf5/hdf5_reader.hpp"

namespace delfront {

namespace {

class Netcdf4 : public NetcdfSource {
 public:
  explicit Netcdf4(const std::string& path) : file_(path) {}

  std::uint64_t dimension(const std::string& name) const override {
    const std::vector<std::uint64_t> extents = file_.shape("/" + name);
    return extents.empty() ? 0 : extents[0];
  }
  bool has(const std::string& variable) const override { return file_.has(place(variable)); }
  std::vector<std::uint64_t> shape(const std::string& variable) const override { return file_.shape(place(variable)); }
  std::vector<double> reals(const std::string& variable) const override { return file_.reals(place(variable)); }
  std::vector<std::int64_t> integers(const std::string& variable) const override {
    return file_.integers(place(variable));
  }
  std::string text(const std::string& variable) const override { return file_.text(file_.array(place(variable))); }
  std::string attribute(const std::string& variable, const std::string& name) const override {
    return file_.text_attribute(variable.empty() ? "/" : place(variable), name);
  }

 private:
  std::string place(const std::string& variable) const {
    const std::string hidden = "/_nc4_non_coord_" + variable;
    return file_.has(hidden) ? hidden : "/" + variable;
  }

  Hdf5Reader file_;
};

}  // namespace

std::unique_ptr<NetcdfSource> open_netcdf4(const std::string& path) { return std::make_unique<Netcdf4>(path); }

}  // namespace delfront
