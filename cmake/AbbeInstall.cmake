# Install and export: a consumer writes find_package(abbe) and links abbe::identify, abbe::formats, ...
include(CMakePackageConfigHelpers)
get_property(abbe_libraries GLOBAL PROPERTY ABBE_LIBRARIES)
install(TARGETS ${abbe_libraries} EXPORT abbe-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS abbe RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY src/abbe DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  FILES_MATCHING PATTERN "*.h" PATTERN "*_for_test.h" EXCLUDE PATTERN "*_cases.h" EXCLUDE)
install(EXPORT abbe-targets NAMESPACE abbe:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/abbe)
install(DIRECTORY examples/machines DESTINATION ${CMAKE_INSTALL_DATADIR}/abbe OPTIONAL
  FILES_MATCHING PATTERN "*.machine.toml")
install(FILES LICENSE README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
configure_package_config_file(cmake/abbe-config.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/abbe-config.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/abbe)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/abbe-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/abbe-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/abbe-config-version.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/abbe)
# The published readings that `abbe reproduce` recomputes.
install(DIRECTORY tests/golden/aguado tests/golden/liu tests/golden/ma tests/golden/yin DESTINATION ${CMAKE_INSTALL_DATADIR}/abbe/golden)
install(FILES examples/laser_engraver/table-a4.csv DESTINATION ${CMAKE_INSTALL_DATADIR}/abbe/examples/laser_engraver)
