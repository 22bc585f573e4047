# SPDX-License-Identifier: Apache-2.0
execute_process(COMMAND ${PROGRAM} ${CASES} RESULT_VARIABLE status OUTPUT_VARIABLE said ERROR_VARIABLE said)
if(NOT status STREQUAL WANTED)
  message(FATAL_ERROR "exit status of the cases ${status}, wanted ${WANTED} (1: they see the mistake)\n${said}")
endif()
string(REGEX MATCHALL "wanted" seen "${said}")
list(LENGTH seen count)
message(STATUS "seen ${count} times")
