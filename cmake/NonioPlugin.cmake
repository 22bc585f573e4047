# SPDX-License-Identifier: Apache-2.0
# nonio_add_plugin(NAME SOURCE... [LIBRARIES LIBRARY...]): a plugin, ready to be loaded, in the current binary folder. In
# Nonio's own tree it becomes a part of the library of its kind (plugins/CMakeLists.txt).
function(nonio_add_plugin name)
  cmake_parse_arguments(PARSE_ARGV 1 plugin "" "" "LIBRARIES")
  if(COMMAND nonio_add_built_in)
    nonio_add_built_in(${name} "${plugin_UNPARSED_ARGUMENTS}" "${plugin_LIBRARIES}")
    return()
  endif()
  add_library(${name} MODULE ${plugin_UNPARSED_ARGUMENTS})
  set_target_properties(${name} PROPERTIES PREFIX "" CXX_VISIBILITY_PRESET hidden
                        VISIBILITY_INLINES_HIDDEN ON)
  target_compile_features(${name} PRIVATE cxx_std_20)
  target_link_libraries(${name} PRIVATE nonio::sdk nonio::math nonio::controllers ${plugin_LIBRARIES})
endfunction()

# nonio_test_plugin(NAME [FOLDER]): `nonio plugin check`, and of each campaign of FOLDER a run that must give the files of
# its folder `expected`, byte for byte. The folder is read, not listed: the campaigns are data that an engineer adds by
# copying one, `plugin check` reads the same folder, and a campaign that is missing in a list would not be tested.
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
