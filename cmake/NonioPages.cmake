# SPDX-License-Identifier: Apache-2.0
# Scripts and styles of pages, which become part of the program.

# nonio_join(NAME FILE...): sets NAME to the texts of the files, one behind the other.
function(nonio_join name)
  set(all)
  foreach(file ${ARGN})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    file(READ ${file} text)
    string(APPEND all "${text}")
  endforeach()
  set(${name} "${all}" PARENT_SCOPE)
endfunction()

# nonio_policy_source(NAME TEXT): sets NAME to "sha256-" and the digest in base64 of a script or style within a page, as in
# a Content-Security-Policy.
function(nonio_policy_source name text)
  find_package(Python3 REQUIRED COMPONENTS Interpreter)
  # Byte by byte as in the page (file(CONFIGURE NEWLINE_STYLE) adds a line), or the browser refuses it.
  file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/${name}.txt "${text}")
  execute_process(COMMAND ${Python3_EXECUTABLE} -c
    "import base64, hashlib, sys; print('sha256-' + base64.b64encode(hashlib.sha256(open(sys.argv[1], 'rb').read()).digest()).decode(), end='')"
    ${CMAKE_CURRENT_BINARY_DIR}/${name}.txt OUTPUT_VARIABLE source COMMAND_ERROR_IS_FATAL ANY)
  set(${name} "${source}" PARENT_SCOPE)
endfunction()
