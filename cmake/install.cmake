# SPDX-License-Identifier: Apache-2.0
# What `cmake --install` and packages hold, by component: `program` with its manual and completion, `cad` (the module that
# needs OpenCASCADE), `development` for find_package(delfront). `cpack` in the build folder makes a Debian package of each.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(delfront_lib lib)  # not by architecture: the program looks for its module in ../lib

install(TARGETS delfront_cli RUNTIME DESTINATION bin COMPONENT program)
install(FILES docs/man/delfront.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
install(FILES packaging/completion.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME delfront
        COMPONENT program)
if(TARGET delfront_cad_module)
  install(TARGETS delfront_cad_module LIBRARY DESTINATION ${delfront_lib} COMPONENT cad)
endif()

set(package ${delfront_lib}/cmake/delfront)
install(TARGETS delfront ${earlier} delfront_flags delfront_strict EXPORT delfront
        ARCHIVE DESTINATION ${delfront_lib} COMPONENT development)
install(EXPORT delfront FILE delfrontTargets.cmake NAMESPACE delfront:: DESTINATION ${package} COMPONENT development)
install(DIRECTORY include/delfront DESTINATION include COMPONENT development)
configure_package_config_file(packaging/delfrontConfig.cmake.in ${PROJECT_BINARY_DIR}/delfrontConfig.cmake
                              INSTALL_DESTINATION ${package})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/delfrontConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/delfrontConfig.cmake ${PROJECT_BINARY_DIR}/delfrontConfigVersion.cmake
        DESTINATION ${package} COMPONENT development)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME delfront)
set(CPACK_PACKAGE_VENDOR "The delfront authors")
set(CPACK_PACKAGE_CONTACT "The delfront authors <authors@delfront.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "unstructured grid generation for CFD, from CAD or facets to a solver's grid")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program development)
if(TARGET delfront_cad_module)
  list(APPEND CPACK_COMPONENTS_ALL cad)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME delfront)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS delfront-cad)
set(CPACK_DEBIAN_CAD_PACKAGE_NAME delfront-cad)
set(CPACK_DEBIAN_CAD_PACKAGE_DEPENDS "delfront (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libdelfront-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libfmt-dev, libeigen3-dev, zlib1g-dev, libcgns-dev, libhdf5-dev")
include(CPack)
