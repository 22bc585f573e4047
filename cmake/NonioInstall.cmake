# SPDX-License-Identifier: Apache-2.0
# The installed package: program, libraries, plugins, templates, and headers for plugins elsewhere.
include(CMakePackageConfigHelpers)

install(TARGETS nonio_sdk nonio_math EXPORT nonio LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS nonio_model nonio_sign nonio_host nonio_reports LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
foreach(part sdk math)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/engine/${part}/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
endforeach()

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/nonio)
install(EXPORT nonio NAMESPACE nonio:: DESTINATION ${package})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/nonio-config.cmake.in
  ${CMAKE_CURRENT_BINARY_DIR}/nonio-config.cmake INSTALL_DESTINATION ${package})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/nonio-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/nonio-config.cmake
  ${CMAKE_CURRENT_BINARY_DIR}/nonio-config-version.cmake
  ${CMAKE_CURRENT_LIST_DIR}/NonioPlugin.cmake ${CMAKE_CURRENT_LIST_DIR}/NonioCase.cmake DESTINATION ${package})
