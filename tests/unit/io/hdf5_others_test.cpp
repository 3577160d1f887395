// SPDX-License-Identifier: Apache-2.0
// XDMF, VTKHDF and Exodus that other programs made, changed or moved: what is refused, what is said.
#if __has_include(<hdf5.h>)
#include <hdf5.h>

#include <cmath>
#include <functional>

#include "io/hdf5/hdf5_writer.hpp"
#include "io_fixtures.hpp"

namespace delfront {
namespace {

using namespace fixtures;
namespace fs = std::filesystem;

TEST(Xdmf, any_name_of_a_file_finds_its_arrays) {
  const fs::path folder = scratch_folder("io_xdmf_names");
  Context context;
  for (const char* name : {"R&D.xdmf", "a<b>\"c\"'d'.xdmf", " lead.xdmf", "trail .xdmf", "\ttab.xmf", "&amp;.xdmf",
                           "a:b.xdmf", "new\nline.xdmf"}) {
    SCOPED_TRACE(name);
    write_mesh(two_boxes(), (folder / name).string(), context);
    expect_same(read_mesh((folder / name).string(), context), two_boxes());
  }
  fs::rename(folder / "R&D.h5", folder / "R'D.h5");
  std::string text = contents(folder / "R&D.xdmf");
  for (std::size_t at = text.find("&amp;"); at != std::string::npos; at = text.find("&amp;"))
    text.replace(at, 5, "&#x27;");
  std::ofstream(folder / "other.xdmf", std::ios::binary) << text;
  expect_same(read_mesh((folder / "other.xdmf").string(), context), two_boxes());
}

}  // namespace
}  // namespace delfront
#endif
