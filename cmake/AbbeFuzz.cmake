# abbe_fuzz(READER LINK fuzz_formats ... [SOURCES a.cpp ...]): a libFuzzer program from fuzz/fuzz_READER.cpp and perhaps some
# sources of a library that would take long to build as a whole, starting at fuzz/corpus/READER.
#
# ctest runs it so that a finding can be repeated (fuzz/run_reader); run the program itself for other inputs. Findings
# are kept in the build folder as fuzz/found/READER/finding-*; the corpus in the source tree is never written. ABBE_FUZZ_SECONDS
# in the environment says how long each reader is fuzzed (default 10, at most 3600).

function(abbe_fuzz reader)
  cmake_parse_arguments(ARG "" "" "LINK;SOURCES" ${ARGN})
  add_executable(fuzz_${reader} fuzz_${reader}.cpp ${ARG_SOURCES})
  target_link_libraries(fuzz_${reader} PRIVATE ${ARG_LINK} fuzz_one_thread abbe_flags)
  target_include_directories(fuzz_${reader} PRIVATE ${PROJECT_SOURCE_DIR}/src)
  target_link_options(fuzz_${reader} PRIVATE -fsanitize=fuzzer)
  if(fuzz_formats IN_LIST ARG_LINK)
    add_dependencies(fuzz_${reader} abbe_formats)
    set_property(TARGET fuzz_${reader} APPEND PROPERTY LINK_DEPENDS $<TARGET_FILE:abbe_formats>)
  endif()
  add_dependencies(abbe_parts fuzz_${reader})
  add_test(NAME fuzz.${reader}
    COMMAND ${PROJECT_SOURCE_DIR}/fuzz/run_reader $<TARGET_FILE:fuzz_${reader}> ${CMAKE_CURRENT_SOURCE_DIR}/corpus/${reader}
            ${CMAKE_CURRENT_BINARY_DIR}/found/${reader})
  set_tests_properties(fuzz.${reader} PROPERTIES LABELS fuzz TIMEOUT 3720)
endfunction()
