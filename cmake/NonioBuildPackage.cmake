# SPDX-License-Identifier: Apache-2.0
# The build folder has the CMake package at the place where an installation has it: with its bin on the PATH,
# find_package(nonio) finds it, and a plugin elsewhere is built without installing anything.
set(package ${CMAKE_BINARY_DIR}/${CMAKE_INSTALL_LIBDIR}/cmake/nonio)
file(MAKE_DIRECTORY ${package})
export(EXPORT nonio NAMESPACE nonio:: FILE ${package}/nonio.cmake)
foreach(file ${CMAKE_CURRENT_BINARY_DIR}/nonio-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/nonio-config-version.cmake
        ${CMAKE_CURRENT_LIST_DIR}/NonioPlugin.cmake ${CMAKE_CURRENT_LIST_DIR}/NonioCase.cmake)
  configure_file(${file} ${package} COPYONLY)
endforeach()
