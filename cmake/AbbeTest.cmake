# Tests that need more than one folder; unit tests stand beside their source and are named in abbe_library().
#
# abbe_cross_test(NAME SOURCES a_test.cpp ... LINK abbe::identify ... [LABEL quick|long] [TIMEOUT seconds] [USES_COMMAND]
#   [COMPUTES])
#
# Quick tests run on every build and under the sanitizers; long ones only in `make long`. USES_COMMAND: the test runs the
# `abbe` command, which may start its companion programs, leaves the computing to it, unless it COMPUTES (AbbeUnits.cmake),
# and is given its path as ABBE_COMMAND.
# Every test gets ABBE_SOURCE_DIR, to find examples/ and tests/golden/.
function(abbe_cross_test name)
  cmake_parse_arguments(ARG "USES_COMMAND;COMPUTES" "LABEL;TIMEOUT" "SOURCES;LINK" ${ARGN})
  if(NOT ARG_LABEL)
    set(ARG_LABEL quick)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  add_executable(${name})
  set(little "")
  if(ARG_USES_COMMAND AND NOT ARG_COMPUTES)
    set(little COMPUTES_LITTLE)
  endif()
  abbe_test_units(${name} ${PROJECT_SOURCE_DIR}/tests SOURCES ${ARG_SOURCES} ${little})
  target_compile_features(${name} PRIVATE cxx_std_20)
  target_compile_definitions(${name} PRIVATE ABBE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  target_link_libraries(${name} PRIVATE ${ARG_LINK} abbe_test_flags GTest::gtest_main GTest::gmock)
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  if(ARG_USES_COMMAND)
    target_compile_definitions(${name} PRIVATE ABBE_COMMAND="$<TARGET_FILE:abbe>")
    add_dependencies(${name} abbe abbe-papers)
    if(TARGET abbe-step)
      add_dependencies(${name} abbe-step)
    endif()
  endif()
  if(ARG_LABEL STREQUAL long)
    abbe_long_program(${name})
  endif()
  abbe_discover_tests(${name} "${name}." "${ARG_LABEL}" ${ARG_TIMEOUT})
endfunction()
