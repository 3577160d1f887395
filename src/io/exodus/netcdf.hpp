// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/output.hpp"

namespace delfront {

/// @brief What is in a netCDF file, classic or netCDF-4: dimensions, variables, attributes of text. All throw
/// InputError with the file and the variable; memory stays proportional to what is stored.
class NetcdfSource {
 public:
  virtual ~NetcdfSource() = default;
  /// @return 0 where there is none
  virtual std::uint64_t dimension(const std::string& name) const = 0;
  virtual bool has(const std::string& variable) const = 0;
  /// @brief Extents; those of records first.
  virtual std::vector<std::uint64_t> shape(const std::string& variable) const = 0;
  virtual std::vector<double> reals(const std::string& variable) const = 0;
  virtual std::vector<std::int64_t> integers(const std::string& variable) const = 0;
  /// @brief Characters, row-major.
  virtual std::string text(const std::string& variable) const = 0;
  /// @param variable  "" for those of the file @return "" where there is none
  virtual std::string attribute(const std::string& variable, const std::string& name) const = 0;
};

/// @brief The classic formats (CDF-1, CDF-2 of 64-bit offsets, CDF-5) in memory.
/// @throws InputError  damaged, truncated
std::unique_ptr<NetcdfSource> open_netcdf_classic(std::string_view bytes, const std::string& path);

/// @brief netCDF-4, which is HDF5; only where that was there when this was built. Hold a Hdf5Turn meanwhile.
std::unique_ptr<NetcdfSource> open_netcdf4(const std::string& path);

/// @brief Writes a classic file, CDF-2, or CDF-5 where a variable takes 4 GiB or more: first what there is, then all of
/// it by write(). Big-endian, without times.
class NetcdfWriter {
 public:
  enum class Type : std::uint8_t { text = 2, integer = 4, single_real = 5, real = 6 };
  using Put = std::function<void(NetcdfWriter&)>;  ///< calls put() for each value, text() for characters

  explicit NetcdfWriter(Output& out) : out_(out) {}

  /// @param length  0: the dimension of records, of which there are none
  /// @return its number
  std::size_t add_dimension(const std::string& name, std::uint64_t length);
  void add_attribute(const std::string& name, const std::string& text);
  void add_attribute(const std::string& name, std::int32_t value);
  void add_attribute(const std::string& name, float value);
  /// @param put  writes exactly the values that the dimensions say
  /// @param attribute  name and text of its one attribute
  void add_variable(const std::string& name, Type type, std::vector<std::size_t> dimensions, Put put,
                    std::pair<std::string, std::string> attribute = {});
  void write();

  void put(double value);
  void put(std::int32_t value);
  /// @brief Characters, filled up with zeros.
  void put_text(std::string_view text, std::size_t width);

 private:
  struct Dimension {
    std::string name;
    std::uint64_t length;
  };
  struct Attribute {
    std::string name;
    Type type;
    std::uint64_t count;
    std::string bytes;
  };
  struct Variable {
    std::string name;
    Type type;
    std::vector<std::size_t> dimensions;
    Put put;
    std::vector<Attribute> attributes;
    std::uint64_t size = 0;  ///< bytes, without padding
    bool is_of_records = false;
  };

  std::string header(std::uint64_t first_offset) const;
  void append_count(std::string& to, std::uint64_t count) const;
  void append_name(std::string& to, const std::string& name) const;
  void append_attributes(std::string& to, const std::vector<Attribute>& attributes) const;

  Output& out_;
  bool is_wide_ = false;  // CDF-5
  std::vector<Dimension> dimensions_;
  std::vector<Attribute> attributes_;
  std::vector<Variable> variables_;
};

}  // namespace delfront
