# abbe_library(NAME SOURCES a.cpp ... DEPENDS geometry ... [LINK lib ...] [PRIVATE_LINK lib ...] [TESTS a_test.cpp ...]
#   [ALONE b.cpp ...] [FAST pattern])
#
# One static library per folder of src/abbe. Its public headers are in include/abbe and are installed; those in src/abbe are
# for the library itself and for tests. DEPENDS names other folders; TESTS are the unit tests that stand beside the
# sources, built into one program per folder. ALONE are sources or tests that cannot share a unit, FAST
# the sources that take the time of users (cmake/AbbeUnits.cmake).
include(AbbeUnits)
include(AbbeFlags)
include(AbbeDiscover)

function(abbe_library name)
  cmake_parse_arguments(ARG "" "FAST" "SOURCES;DEPENDS;LINK;PRIVATE_LINK;TESTS;TEST_LINK;ALONE" ${ARGN})
  if(ARG_SOURCES)
    add_library(abbe_${name} STATIC)
    abbe_units(abbe_${name} ${PROJECT_SOURCE_DIR}/src SOURCES ${ARG_SOURCES} ALONE ${ARG_ALONE} FAST "${ARG_FAST}" PRECOMPILED abbe_precompiled)
    set(scope PUBLIC)
    # In the static programs fmt, Highway, zlib, Expat and SQLite are others (AbbeStatic.cmake); a consumer links the shared ones.
    list(TRANSFORM ARG_PRIVATE_LINK REPLACE "^fmt::fmt$" "$<BUILD_INTERFACE:abbe_fmt>;$<INSTALL_INTERFACE:fmt::fmt>")
    list(TRANSFORM ARG_PRIVATE_LINK REPLACE "^hwy::hwy$" "$<BUILD_INTERFACE:abbe_highway>;$<INSTALL_INTERFACE:hwy::hwy>")
    list(TRANSFORM ARG_PRIVATE_LINK REPLACE "^ZLIB::ZLIB$" "$<BUILD_INTERFACE:abbe_zlib>;$<INSTALL_INTERFACE:ZLIB::ZLIB>")
    list(TRANSFORM ARG_PRIVATE_LINK REPLACE "^EXPAT::EXPAT$" "$<BUILD_INTERFACE:abbe_expat>;$<INSTALL_INTERFACE:EXPAT::EXPAT>")
    list(TRANSFORM ARG_PRIVATE_LINK REPLACE "^SQLite::SQLite3$" "$<BUILD_INTERFACE:abbe_sqlite>;$<INSTALL_INTERFACE:SQLite::SQLite3>")
    target_link_libraries(abbe_${name} PRIVATE $<BUILD_INTERFACE:abbe_flags> ${ARG_PRIVATE_LINK})
    set_target_properties(abbe_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON EXPORT_NAME ${name})
    target_include_directories(abbe_${name} PRIVATE ${PROJECT_SOURCE_DIR}/src)
  else()
    add_library(abbe_${name} INTERFACE)
    set(scope INTERFACE)
    set_target_properties(abbe_${name} PROPERTIES EXPORT_NAME ${name})
  endif()
  add_library(abbe::${name} ALIAS abbe_${name})
  target_compile_features(abbe_${name} ${scope} cxx_std_20)
  target_include_directories(abbe_${name} ${scope}
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  foreach(dependency IN LISTS ARG_DEPENDS)
    target_link_libraries(abbe_${name} ${scope} abbe::${dependency})
  endforeach()
  target_link_libraries(abbe_${name} ${scope} ${ARG_LINK})
  set_property(GLOBAL APPEND PROPERTY ABBE_LIBRARIES abbe_${name})
  # What a user of the library may include: itself, what it depends on, and what these depend on.
  set(seen ${name})
  foreach(dependency IN LISTS ARG_DEPENDS)
    get_property(more GLOBAL PROPERTY ABBE_SEEN_FROM_${dependency})
    list(APPEND seen ${more})
  endforeach()
  list(REMOVE_DUPLICATES seen)
  set_property(GLOBAL PROPERTY ABBE_SEEN_FROM_${name} ${seen})

  if(ABBE_TESTS AND ARG_TESTS)
    add_executable(${name}_test)
    abbe_units(${name}_test ${PROJECT_SOURCE_DIR}/src SOURCES ${ARG_TESTS} ALONE ${ARG_ALONE} PRECOMPILED abbe_test_precompiled)
    target_link_libraries(${name}_test PRIVATE abbe::${name} abbe_test_flags ${ARG_TEST_LINK} GTest::gtest_main GTest::gmock)
    abbe_discover_tests(${name}_test "${name}." unit 300)
  endif()
endfunction()
