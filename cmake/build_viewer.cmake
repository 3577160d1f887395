# SPDX-License-Identifier: Apache-2.0
# The page of `delfront view`, bundled from viewer/ and put into the program as it is (src/view/page.cpp). Needs node,
# and what scripts/setup has npm put into viewer/node_modules; without them the program says so.
set(viewer_folder ${PROJECT_SOURCE_DIR}/viewer)
set(DELFRONT_HAS_VIEWER OFF)
if(DELFRONT_VIEWER STREQUAL "OFF")
  return()
endif()
find_program(DELFRONT_NODE NAMES node nodejs)
set(vite ${viewer_folder}/node_modules/vite/bin/vite.js)
if(NOT DELFRONT_NODE OR NOT EXISTS ${vite})
  set(missing "node and the packages of viewer/package-lock.json (scripts/setup installs them; by hand: npm ci in viewer/)")
  if(DELFRONT_VIEWER STREQUAL "ON")
    message(FATAL_ERROR "DELFRONT_VIEWER is ON, but there are no ${missing}")
  endif()
  message(STATUS "The page of 'delfront view' is left out: there are no ${missing}")
  return()
endif()
set(DELFRONT_HAS_VIEWER ON)
set(page ${PROJECT_BINARY_DIR}/viewer/index.html)
file(GLOB viewer_sources CONFIGURE_DEPENDS ${viewer_folder}/src/*)
add_custom_command(
  OUTPUT ${page}
  COMMAND ${DELFRONT_NODE} ${vite} build --outDir ${PROJECT_BINARY_DIR}/viewer --emptyOutDir --logLevel warn
  WORKING_DIRECTORY ${viewer_folder}
  DEPENDS ${viewer_sources} ${viewer_folder}/index.html ${viewer_folder}/vite.config.js ${viewer_folder}/package-lock.json
  COMMENT "Bundling the page of delfront view"
  VERBATIM)
set_source_files_properties(src/view/page.cpp PROPERTIES OBJECT_DEPENDS ${page}
                                                         COMPILE_DEFINITIONS "DELFRONT_VIEWER_PAGE=\"${page}\"")
