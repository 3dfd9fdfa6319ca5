# What `cpack` makes, and so `make package`: Debian packages, and the tarball that runs on any Linux (cmake/AbbeStatic.cmake),
# for which the target abbe_static has to be built too. Text for people is in packaging/.
set(packaging ${PROJECT_SOURCE_DIR}/packaging)
set(made ${CMAKE_CURRENT_BINARY_DIR}/packaging)
set(CPACK_PACKAGE_NAME abbe)
set(CPACK_PACKAGE_VENDOR "The Abbe authors")
set(CPACK_PACKAGE_CONTACT "The Abbe authors <abbe-authors@example.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_THREADS 0)

set(CPACK_GENERATOR DEB TGZ)
# The tarball is one, of components of its own: read by cpack for each of the two.
string(TOLOWER "${CMAKE_SYSTEM_NAME}-${CMAKE_SYSTEM_PROCESSOR}" abbe_system)
set(CPACK_PACKAGE_FILE_NAME abbe-${PROJECT_VERSION}-${abbe_system})
set(CPACK_PROJECT_CONFIG_FILE ${made}/generator.cmake)
file(CONFIGURE OUTPUT ${made}/generator.cmake @ONLY CONTENT [[
if(CPACK_GENERATOR STREQUAL "TGZ")
  set(CPACK_MONOLITHIC_INSTALL ON)
  set(CPACK_PACKAGING_INSTALL_PREFIX "")
  set(CPACK_INSTALL_CMAKE_PROJECTS "")
  foreach(component IN ITEMS static data elsewhere_in_debian)
    list(APPEND CPACK_INSTALL_CMAKE_PROJECTS "@CMAKE_BINARY_DIR@" abbe ${component} /)
  endforeach()
endif()
]])

# A package per group of components; a group has files that only the Debian package needs in a component of its own.
# CPack knows packages by the names of groups in upper case.
set(groups COMMAND LIBRARY)
set(name_COMMAND abbe)
set(component_COMMAND runtime)
set(CPACK_COMPONENT_DATA_GROUP COMMAND)
list(APPEND CPACK_COMPONENTS_ALL data)
set(name_LIBRARY libabbe-dev)
set(component_LIBRARY development)
if(TARGET abbekins)
  list(APPEND groups MODULE)
  set(name_MODULE abbe-linuxcnc)
  set(component_MODULE linuxcnc)
endif()

# Debian's changelog has the release and points to ours.
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/CHANGELOG.md)
execute_process(COMMAND date --utc --rfc-email "--date=${ABBE_RELEASE_DATE}" OUTPUT_VARIABLE abbe_release_date
  OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)

# abbe_compress(IN OUT): as Debian's policy asks, with the same bytes each time.
function(abbe_compress in out)
  configure_file(${in} ${out} COPYONLY)
  execute_process(COMMAND gzip -9nf ${out} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

foreach(group IN LISTS groups)
  set(package ${name_${group}})
  set(component debian_${component_${group}})
  list(APPEND CPACK_COMPONENTS_ALL ${component_${group}} ${component})
  string(TOUPPER ${component_${group}} upper)
  set(CPACK_COMPONENT_${upper}_GROUP ${group})
  string(TOUPPER ${component} upper)
  set(CPACK_COMPONENT_${upper}_GROUP ${group})
  set(CPACK_DEBIAN_${group}_PACKAGE_NAME ${package})
  set(CPACK_DEBIAN_${group}_PACKAGE_SHLIBDEPS ON)
  file(READ ${packaging}/debian/${package}.description CPACK_DEBIAN_${group}_DESCRIPTION)
  file(MAKE_DIRECTORY ${made}/${package})
  configure_file(${packaging}/debian/changelog.in ${made}/${package}/changelog.Debian @ONLY)
  abbe_compress(${made}/${package}/changelog.Debian ${made}/${package}/changelog.Debian)
  abbe_compress(${PROJECT_SOURCE_DIR}/CHANGELOG.md ${made}/${package}/changelog)
  configure_file(${packaging}/debian/${package}.copyright ${made}/${package}/copyright COPYONLY)
  install(FILES ${made}/${package}/changelog.Debian.gz ${made}/${package}/changelog.gz ${made}/${package}/copyright
    DESTINATION share/doc/${package} COMPONENT ${component} EXCLUDE_FROM_ALL)
  if(EXISTS ${packaging}/debian/${package}.lintian-overrides)
    install(FILES ${packaging}/debian/${package}.lintian-overrides DESTINATION share/lintian/overrides RENAME ${package}
      COMPONENT ${component} EXCLUDE_FROM_ALL)
  endif()
endforeach()

install(FILES ${abbe_pages}/completion/zsh DESTINATION share/zsh/vendor-completions RENAME _abbe
  COMPONENT debian_runtime EXCLUDE_FROM_ALL)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ
    WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMMAND_PACKAGE_SECTION science)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_MODULE_PACKAGE_SECTION electronics)
# What abbe-config.cmake looks for. Programs of a consumer are linked with the shared libraries that these packages are of.
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS
  "libeigen3-dev (>= 3.4), libfmt-dev (>= 9), libhwy-dev (>= 1.0), libtomlplusplus-dev (>= 3), nlohmann-json3-dev (>= 3.11), zlib1g-dev, libexpat1-dev (>= 2.5), libsqlite3-dev (>= 3.40)")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SUGGESTS abbe)
set(CPACK_DEBIAN_MODULE_PACKAGE_DEPENDS "linuxcnc-uspace (>= 2.9~), linuxcnc-uspace (<< 2.10~), python3")
set(CPACK_DEBIAN_MODULE_PACKAGE_RECOMMENDS abbe)
set(CPACK_DEBIAN_COMMAND_PACKAGE_SUGGESTS "libabbe-dev, abbe-linuxcnc, chromium | weasyprint, fonts-noto-cjk")
include(CPack)
