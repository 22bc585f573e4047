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
# The build folder has the package at the same place: with its bin on the PATH, find_package(nonio) finds it there too.
export(EXPORT nonio NAMESPACE nonio:: FILE ${CMAKE_BINARY_DIR}/${package}/nonio.cmake)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/nonio-config.cmake.in
  ${CMAKE_BINARY_DIR}/${package}/nonio-config.cmake INSTALL_DESTINATION ${package})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/${package}/nonio-config-version.cmake
  COMPATIBILITY SameMinorVersion)
foreach(file NonioPlugin.cmake NonioCase.cmake)
  configure_file(${CMAKE_CURRENT_LIST_DIR}/${file} ${CMAKE_BINARY_DIR}/${package}/${file} COPYONLY)
endforeach()
foreach(file nonio-config.cmake nonio-config-version.cmake NonioPlugin.cmake NonioCase.cmake)
  install(FILES ${CMAKE_BINARY_DIR}/${package}/${file} DESTINATION ${package})
endforeach()
