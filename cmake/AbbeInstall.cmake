# Install and export. `make install` installs the components runtime (the command and its companions), data (examples,
# documentation, manual pages), mpi, elsewhere_in_debian, and development: a consumer writes find_package(abbe) and links
# abbe::identify, abbe::formats, ... cmake/AbbePackage.cmake makes packages of them, of linuxcnc (linuxcnc/CMakeLists.txt) and
# of static, the command for any Linux.
set(abbe_data ${CMAKE_INSTALL_DATADIR}/abbe)
install(TARGETS abbe abbe-papers RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime)
install(PROGRAMS ${ABBE_STATIC_DIRECTORY}/abbe ${ABBE_STATIC_DIRECTORY}/abbe-papers DESTINATION bin
  COMPONENT static EXCLUDE_FROM_ALL)
install(SCRIPT ${PROJECT_SOURCE_DIR}/packaging/tarball/licences.cmake COMPONENT static EXCLUDE_FROM_ALL)
if(TARGET abbe-step)
  install(TARGETS abbe-step RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime)
  install(TARGETS abbe-step RUNTIME DESTINATION lib/abbe COMPONENT static EXCLUDE_FROM_ALL)
  install(SCRIPT ${PROJECT_SOURCE_DIR}/packaging/tarball/bundle.cmake COMPONENT static EXCLUDE_FROM_ALL)
endif()
# No package contains it: it is linked with the MPI of this machine.
if(TARGET abbe-mpi)
  install(TARGETS abbe-mpi RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT mpi)
endif()
# The examples: those of the help, and what `abbe reproduce` reads. The closed loop and the thermal day are scripts of the
# source tree.
set(abbe_program_permissions OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
install(DIRECTORY examples DESTINATION ${abbe_data} COMPONENT data PATTERN closed_loop EXCLUDE PATTERN thermal_day EXCLUDE
  REGEX "/fleet/(submit|fleet\\.sbatch|fleet\\.py)$" PERMISSIONS ${abbe_program_permissions})
# The published readings that `abbe reproduce` recomputes.
install(DIRECTORY tests/golden/aguado tests/golden/liu tests/golden/ma tests/golden/yin DESTINATION ${abbe_data}/golden
  COMPONENT data FILES_MATCHING PATTERN "*.csv" PATTERN "*.json")
install(FILES README.md CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT data)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT data PATTERN site EXCLUDE)
# Manual pages and completions: the command makes them of its own options.
set(abbe_pages ${CMAKE_CURRENT_BINARY_DIR}/pages)
add_custom_command(OUTPUT ${abbe_pages}/completion/bash
  COMMAND ${CMAKE_COMMAND} -DABBE=$<TARGET_FILE:abbe> -DSOURCE=${PROJECT_SOURCE_DIR} -DOUT=${abbe_pages}
    -P ${PROJECT_SOURCE_DIR}/cmake/write_pages.cmake
  DEPENDS abbe cmake/write_pages.cmake packaging/abbe-step.1 COMMENT "Manual pages and completions" VERBATIM)
add_custom_target(abbe_pages ALL DEPENDS ${abbe_pages}/completion/bash)
install(DIRECTORY ${abbe_pages}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT data)
install(FILES ${abbe_pages}/completion/bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME abbe
  COMPONENT data)
install(FILES ${abbe_pages}/completion/fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d RENAME abbe.fish
  COMPONENT data)
# What Debian's packages have elsewhere or under another name (cmake/AbbePackage.cmake).
install(FILES ${abbe_pages}/completion/zsh DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions RENAME _abbe
  COMPONENT elsewhere_in_debian)
install(FILES LICENSE CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT elsewhere_in_debian)

include(CMakePackageConfigHelpers)
get_property(abbe_libraries GLOBAL PROPERTY ABBE_LIBRARIES)
install(TARGETS ${abbe_libraries} EXPORT abbe-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
install(DIRECTORY include/abbe DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
install(EXPORT abbe-targets NAMESPACE abbe:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/abbe COMPONENT development)
configure_package_config_file(cmake/abbe-config.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/abbe-config.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/abbe)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/abbe-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/abbe-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/abbe-config-version.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/abbe COMPONENT development)
