# SPDX-License-Identifier: Apache-2.0
# Runs the campaign CASE with the plugins of PLUGINS into OUT, and holds what comes out against CASE/expected.
file(REMOVE_RECURSE ${OUT})
file(COPY ${CASE} DESTINATION ${OUT}/site)
execute_process(COMMAND ${NONIO} run ${OUT}/site --out ${OUT}/out --plugin-path ${PLUGINS} RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "nonio run ended with ${status}")
endif()
# A script at the time of the test, not a build: what the folder holds is what is wanted.
file(GLOB_RECURSE wanted RELATIVE ${CASE}/expected ${CASE}/expected/*)
if(NOT wanted)
  message(FATAL_ERROR "${CASE}/expected is empty: nothing is compared")
endif()
get_filename_component(name ${CASE} NAME)
foreach(file IN LISTS wanted)
  execute_process(COMMAND ${CMAKE_COMMAND} -E compare_files ${CASE}/expected/${file} ${OUT}/out/${name}/${file}
                  RESULT_VARIABLE differs)
  if(differs)
    execute_process(COMMAND diff ${CASE}/expected/${file} ${OUT}/out/${name}/${file})
    message(FATAL_ERROR "${file} is not what is expected (${OUT}/out/${name}/${file})")
  endif()
endforeach()
