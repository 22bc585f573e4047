# SPDX-License-Identifier: Apache-2.0
# `cmake --build BUILD --target package`: nonio_*.deb, libnonio-dev_*.deb and, with pybind11, python3-nonio_*.deb. What only a package has (timer, user, Debian's
# papers) is left out by `cmake --install`.
set(NONIO_PACKAGE_CONTACT "Nonio maintainers <nonio@localhost>" CACHE STRING
    "Maintainer of the packages: name <address> of who builds and hands them on")
set(parts ${CMAKE_CURRENT_LIST_DIR}/package)

# Without them CPack would make a package that depends on nothing.
find_program(SHLIBDEPS dpkg-shlibdeps)
find_program(FILE_PROGRAM file)
if(NOT SHLIBDEPS OR NOT FILE_PROGRAM)
  message(STATUS "No target package: it needs dpkg-shlibdeps and file (Debian packages dpkg-dev and file)")
  return()
endif()

# Version and revision are those of the changelog's first line.
file(STRINGS ${parts}/changelog newest LIMIT_COUNT 1)
if(NOT newest MATCHES "^nonio \\((.+)-([^-]+)\\) " OR NOT CMAKE_MATCH_1 STREQUAL PROJECT_VERSION)
  message(FATAL_ERROR "cmake/package/changelog: expected version ${PROJECT_VERSION} of the project on top, found \"${newest}\"")
endif()
set(revision ${CMAKE_MATCH_2})
configure_file(${parts}/changelog ${CMAKE_BINARY_DIR}/package/changelog.Debian @ONLY)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${parts}/changelog)
execute_process(COMMAND ${GZIP} -9nkf ${CMAKE_BINARY_DIR}/package/changelog.Debian COMMAND_ERROR_IS_FATAL ANY)

function(pack component package)
  install(FILES ${parts}/copyright ${CMAKE_BINARY_DIR}/package/changelog.Debian.gz DESTINATION share/doc/${package}
          COMPONENT ${component} EXCLUDE_FROM_ALL)
  install(FILES ${parts}/${package}.lintian-overrides DESTINATION share/lintian/overrides RENAME ${package}
          COMPONENT ${component} EXCLUDE_FROM_ALL)
endfunction()
pack(nonio nonio)
pack(dev libnonio-dev)
if(TARGET nonio_python)
  pack(python python3-nonio)
endif()
install(FILES ${parts}/nonio.service ${parts}/nonio.timer ${parts}/nonio-serve.service DESTINATION lib/systemd/system COMPONENT nonio EXCLUDE_FROM_ALL)
install(FILES ${parts}/nonio.default DESTINATION /etc/default RENAME nonio COMPONENT nonio EXCLUDE_FROM_ALL)
install(FILES ${parts}/Containerfile DESTINATION share/doc/nonio/examples COMPONENT nonio EXCLUDE_FROM_ALL)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "${NONIO_PACKAGE_CONTACT}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")
set(CPACK_VERBATIM_VARIABLES ON)
# With DESTDIR, because /etc/default is outside of the prefix.
set(CPACK_SET_DESTDIR ON)
set(CPACK_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_THREADS 0)
set(CPACK_COMPONENTS_ALL nonio dev)
if(TARGET nonio_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE ${revision})
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

set(CPACK_DEBIAN_NONIO_PACKAGE_NAME nonio)
set(CPACK_DEBIAN_NONIO_PACKAGE_SECTION science)
set(CPACK_DEBIAN_NONIO_DESCRIPTION "batch evaluation of machine-tool calibrations
Nonio evaluates the readings of laser interferometers and other instruments
on machine tools by the standards (ISO 230-2, VDI/DGQ 3441), a whole site of
campaigns every night. It says what the numbers mean, with their uncertainty,
and writes the compensation tables of the machine's control, a report, and
signed calibration certificates.

Formats, analyses, physical effects and controls are plugins; those of
Nonio itself are in this package, libnonio-dev is for plugins of your own.
A systemd timer for the nightly run comes with it, not enabled.")
set(CPACK_DEBIAN_NONIO_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_BINARY_DIR}/${NONIO_LIBRARY_SUBDIR})
set(CPACK_DEBIAN_NONIO_PACKAGE_DEPENDS adduser)
# openssl for the key of a sample, the engine for keys in a token.
set(CPACK_DEBIAN_NONIO_PACKAGE_SUGGESTS "libnonio-dev, openssl, libengine-pkcs11-openssl")
set(CPACK_DEBIAN_NONIO_PACKAGE_CONTROL_STRICT_PERMISSION ON)
file(WRITE ${CMAKE_BINARY_DIR}/package/conffiles "/etc/default/nonio\n")
set(CPACK_DEBIAN_NONIO_PACKAGE_CONTROL_EXTRA
    ${parts}/postinst ${parts}/prerm ${parts}/postrm ${CMAKE_BINARY_DIR}/package/conffiles)

set(CPACK_DEBIAN_DEV_PACKAGE_NAME libnonio-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SOURCE nonio)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_DESCRIPTION "batch evaluation of machine-tool calibrations (plugin development)
Nonio evaluates calibrations of machine tools. Readers of instrument files,
analyses, physical effects, outputs and tables of controls are plugins.

This package has what a plugin of your own needs: the headers, the CMake
package, a kit for tables of controls, and the skeletons that the command
\"nonio plugin new\" begins one with.")
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "nonio (= ${PROJECT_VERSION}-${revision}), libexpected-dev")
set(CPACK_DEBIAN_DEV_PACKAGE_RECOMMENDS "cmake, g++")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-nonio)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SOURCE nonio)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "batch evaluation of machine-tool calibrations (Python package)
Nonio evaluates calibrations of machine tools. This package reads campaigns,
evaluates them and fits models to them in Python, also with physical effects
that are written in Python. It calls the libraries of Nonio, so the numbers are
those of the program.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "nonio (= ${PROJECT_VERSION}-${revision}), python3 (>= 3.11), python3 (<< 3.12)")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "python3-pandas")
include(CPack)
