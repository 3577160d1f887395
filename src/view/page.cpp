// SPDX-License-Identifier: Apache-2.0
#include "view/page.hpp"

#include <zlib.h>

#include "base/base64.hpp"
#include "delfront/errors.hpp"

#ifdef DELFRONT_VIEWER_PAGE
// The file as it is, without a detour over megabytes of numbers for the compiler.
asm(".section .rodata\n"
    ".global delfront_viewer_page_begin\n"
    ".global delfront_viewer_page_end\n"
    "delfront_viewer_page_begin:\n"
    ".incbin \"" DELFRONT_VIEWER_PAGE
    "\"\n"
    "delfront_viewer_page_end:\n"
    ".byte 0\n"
    ".previous\n");
extern "C" const char delfront_viewer_page_begin[], delfront_viewer_page_end[];
#endif

namespace delfront {

namespace {
constexpr std::string_view kPlaceOfData = "<!--delfront-data-->";  // as in viewer/index.html
}

std::string_view built_page() {
#ifdef DELFRONT_VIEWER_PAGE
  return {delfront_viewer_page_begin, static_cast<std::size_t>(delfront_viewer_page_end - delfront_viewer_page_begin)};
#else
  return {};
#endif
}

std::string_view page_or_throw() {
  if (built_page().empty())
    throw UsageError(
        "this delfront was built without its viewer, which needs node and npm; install them, run scripts/setup and "
        "build again, or look at the grid with ParaView (delfront convert writes VTU)");
  return built_page();
}

std::string make_export(std::string_view page, const std::string& data) {
  std::string packed(compressBound(data.size()), '\0');
  uLongf size = packed.size();
  const int status = compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                               reinterpret_cast<const Bytef*>(data.data()), data.size(), Z_BEST_COMPRESSION);
  DELFRONT_CHECK(status == Z_OK);
  packed.resize(size);
  const std::size_t place = page.find(kPlaceOfData);
  DELFRONT_CHECK(place != std::string_view::npos);
  std::string result(page.substr(0, place));
  result += "<script type=\"text/plain\" id=\"delfront-data\">" + to_base64(packed) + "</script>";
  result += page.substr(place + kPlaceOfData.size());
  return result;
}

}  // namespace delfront
