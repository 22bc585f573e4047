# SPDX-License-Identifier: Apache-2.0
# What is installed: program, libraries, plugins, templates, man page, docs, samples; component `dev`: headers for plugins elsewhere.
include(CMakePackageConfigHelpers)

# In a folder of their own: no program but nonio and its plugins is to link with them, and they keep no ABI between versions.
install(TARGETS nonio_sdk EXPORT nonio ARCHIVE DESTINATION ${NONIO_LIBRARY_SUBDIR} COMPONENT dev)
install(TARGETS nonio_math EXPORT nonio LIBRARY DESTINATION ${NONIO_LIBRARY_SUBDIR} NAMELINK_COMPONENT dev)
install(TARGETS nonio_statistics nonio_model nonio_pdf nonio_sign nonio_engine nonio_reports LIBRARY DESTINATION ${NONIO_LIBRARY_SUBDIR} NAMELINK_SKIP)
get_property(late GLOBAL PROPERTY NONIO_LATE_LIBRARIES)
install(TARGETS ${late} LIBRARY DESTINATION ${NONIO_LIBRARY_SUBDIR})
set(public sdk)
foreach(room statistics axis uncertainty planning findings followed volumetric rotary circles heat compensation)
  list(APPEND public math/${room})
endforeach()
foreach(folder IN LISTS public)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/engine/${folder}/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev)
endforeach()

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/nonio)
install(EXPORT nonio NAMESPACE nonio:: DESTINATION ${package} COMPONENT dev)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/nonio-config.cmake.in
  ${CMAKE_CURRENT_BINARY_DIR}/nonio-config.cmake INSTALL_DESTINATION ${package})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/nonio-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/nonio-config.cmake
  ${CMAKE_CURRENT_BINARY_DIR}/nonio-config-version.cmake
  ${CMAKE_CURRENT_LIST_DIR}/NonioPlugin.cmake ${CMAKE_CURRENT_LIST_DIR}/NonioCase.cmake DESTINATION ${package} COMPONENT dev)

# What the program says of itself.
find_program(GZIP gzip REQUIRED)
set(man ${CMAKE_BINARY_DIR}/${CMAKE_INSTALL_MANDIR}/man1/nonio.1)
set(bash ${CMAKE_BINARY_DIR}/${CMAKE_INSTALL_DATADIR}/bash-completion/completions/nonio)
set(zsh ${CMAKE_BINARY_DIR}/${CMAKE_INSTALL_DATADIR}/zsh/_nonio)
foreach(file man bash zsh)
  get_filename_component(folder ${${file}} DIRECTORY)
  file(MAKE_DIRECTORY ${folder})
endforeach()
add_custom_command(OUTPUT ${man}.gz ${bash} ${zsh}
  COMMAND nonio help --man > ${man}
  COMMAND ${GZIP} -9nkf ${man}
  COMMAND nonio completion bash > ${bash}
  COMMAND nonio completion zsh > ${zsh}
  DEPENDS nonio VERBATIM COMMENT "Man page and completion")
add_custom_target(nonio_pages_of_help ALL DEPENDS ${man}.gz ${bash} ${zsh})
install(FILES ${man}.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${bash} DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
# zsh of Debian looks into vendor-completions below /usr/share, and into site-functions below /usr/local/share.
install(CODE "
  set(folder site-functions)
  if(CMAKE_INSTALL_PREFIX STREQUAL \"/usr\")
    set(folder vendor-completions)
  endif()
  file(INSTALL \"${zsh}\" DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}/zsh/\${folder}\")")

# Docs, the papers of each plugin, and samples to try it on.
set(papers ${CMAKE_INSTALL_DATADIR}/doc/nonio)
# Scripts that users adapt.
install(PROGRAMS ${PROJECT_SOURCE_DIR}/cmake/package/slurm/nonio-night ${PROJECT_SOURCE_DIR}/cmake/package/slurm/nonio-shard.sbatch
        DESTINATION ${CMAKE_INSTALL_DATADIR}/nonio/slurm)
# The same as pages with search.
find_program(MKDOCS mkdocs)
if(MKDOCS AND EXISTS /usr/share/mkdocs/themes/material)
  set(site ${CMAKE_BINARY_DIR}/site)
  # What the pages are made from is listed by the hook.
  add_custom_command(OUTPUT ${site}/index.html DEPFILE ${site}.d
    COMMAND ${CMAKE_COMMAND} -E env NONIO_DEPFILE=${site}.d PYTHONDONTWRITEBYTECODE=1 ${MKDOCS} build --quiet --strict --site-dir ${site}
    DEPENDS ${PROJECT_SOURCE_DIR}/mkdocs.yml WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} VERBATIM COMMENT "Pages of the documentation")
  add_custom_target(docs_site ALL DEPENDS ${site}/index.html)
  install(DIRECTORY ${site}/ DESTINATION ${papers}/site)
else()
  message(STATUS "mkdocs-material not found: the documentation is installed without its pages")
endif()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/ DESTINATION ${papers} FILES_MATCHING PATTERN style EXCLUDE PATTERN *.md PATTERN *.png PATTERN *.svg)
foreach(folder IN LISTS NONIO_PLUGIN_FOLDERS)
  install(FILES ${PROJECT_SOURCE_DIR}/plugins/${folder}/README.md DESTINATION ${papers}/plugins/${folder})
endforeach()
# Named one by one, so that a key or a register made here for a trial is not installed.
set(samples ${PROJECT_SOURCE_DIR}/samples)
install(DIRECTORY ${samples}/site ${samples}/laboratory ${samples}/simulate ${samples}/tutorial ${samples}/notebooks ${samples}/plugins DESTINATION ${papers}/examples)
install(DIRECTORY ${samples}/certificates/adjusted DESTINATION ${papers}/examples/certificates)
install(FILES ${samples}/certificates/site.toml DESTINATION ${papers}/examples/certificates)
install(PROGRAMS ${samples}/certificates/make-key.sh DESTINATION ${papers}/examples/certificates)
install(FILES ${samples}/README.md DESTINATION ${papers}/examples)
