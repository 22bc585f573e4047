# SPDX-License-Identifier: Apache-2.0
# nonio_add_plugin(NAME SOURCE...): a plugin, ready to be loaded. In Nonio's own tree it goes where
# the program looks for plugins; elsewhere it stays in the current binary folder.
function(nonio_add_plugin name)
  add_library(${name} MODULE ${ARGN})
  set_target_properties(${name} PROPERTIES PREFIX "" CXX_VISIBILITY_PRESET hidden
                        VISIBILITY_INLINES_HIDDEN ON)
  target_compile_features(${name} PRIVATE cxx_std_20)
  if(TARGET nonio_math)
    target_link_libraries(${name} PRIVATE nonio_sdk nonio_math nonio_warnings)
    set_target_properties(${name} PROPERTIES
      LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/${NONIO_PLUGIN_SUBDIR}
      INSTALL_RPATH "$ORIGIN/../..")
    install(TARGETS ${name} LIBRARY DESTINATION ${NONIO_PLUGIN_SUBDIR})
  else()
    target_link_libraries(${name} PRIVATE nonio::sdk nonio::math)
  endif()
endfunction()
