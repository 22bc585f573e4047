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
      INSTALL_RPATH "$ORIGIN/..")
    install(TARGETS ${name} LIBRARY DESTINATION ${NONIO_PLUGIN_SUBDIR})
  else()
    target_link_libraries(${name} PRIVATE nonio::sdk nonio::math nonio::controllers)
  endif()
endfunction()

# nonio_test_plugin(NAME [FOLDER]): `nonio plugin check`, and of each campaign of FOLDER a run that must give the files of
# its folder `expected`, byte for byte. The folder is read, not listed: the campaigns are data of an engineer who copies
# one beside the others, `plugin check` reads the same folder, and a campaign that a list forgot would go untested.
function(nonio_test_plugin name)
  set(samples)
  set(manifests)
  if(ARGC GREATER 1)
    set(samples --cases ${CMAKE_CURRENT_SOURCE_DIR}/${ARGV1})
    file(GLOB manifests CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${ARGV1}/*/campaign.toml)
  endif()
  add_test(NAME ${name}.check COMMAND nonio::nonio plugin check $<TARGET_FILE:${name}> ${samples})
  foreach(manifest IN LISTS manifests)
    get_filename_component(folder ${manifest} DIRECTORY)
    get_filename_component(case ${folder} NAME)
    add_test(NAME ${name}.${case} COMMAND ${CMAKE_COMMAND} -DNONIO=$<TARGET_FILE:nonio::nonio>
      -DPLUGINS=$<TARGET_FILE_DIR:${name}> -DCASE=${folder} -DOUT=${CMAKE_CURRENT_BINARY_DIR}/cases/${case}
      -P ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/NonioCase.cmake)
  endforeach()
endfunction()
