# SPDX-License-Identifier: Apache-2.0
# The build folder is a CMake package too: with its bin on the PATH, find_package(nonio) finds it, and a plugin elsewhere is
# built without installing anything. nonio-config.cmake is there already.
export(EXPORT nonio NAMESPACE nonio:: FILE ${CMAKE_CURRENT_BINARY_DIR}/nonio.cmake)
foreach(file NonioPlugin.cmake NonioCase.cmake)
  configure_file(${CMAKE_CURRENT_LIST_DIR}/${file} ${CMAKE_CURRENT_BINARY_DIR}/${file} COPYONLY)
endforeach()
