# abbe_fuzz(READER LINK abbe::formats ...): a libFuzzer program from fuzz/fuzz_READER.cpp, starting at fuzz/corpus/READER.
#
# The seed is fixed so that a finding can be repeated; run the program itself for others. New inputs are kept in the build folder, findings too; the corpus in the source tree is never written.
set(ABBE_FUZZ_SECONDS 60 CACHE STRING "How long each reader is fuzzed by ctest")

function(abbe_fuzz reader)
  cmake_parse_arguments(ARG "" "" "LINK" ${ARGN})
  add_executable(fuzz_${reader} fuzz_${reader}.cpp)
  target_link_libraries(fuzz_${reader} PRIVATE ${ARG_LINK} abbe_flags)
  target_link_options(fuzz_${reader} PRIVATE -fsanitize=fuzzer)
  set(found ${CMAKE_CURRENT_BINARY_DIR}/found/${reader})
  file(MAKE_DIRECTORY ${found})
  math(EXPR timeout "${ABBE_FUZZ_SECONDS} + 120")
  add_test(NAME fuzz.${reader}
    COMMAND fuzz_${reader} -seed=1 -max_total_time=${ABBE_FUZZ_SECONDS} -timeout=10 -rss_limit_mb=2048 -print_final_stats=1
            -artifact_prefix=${found}/finding- ${found} ${CMAKE_CURRENT_SOURCE_DIR}/corpus/${reader})
  set_tests_properties(fuzz.${reader} PROPERTIES LABELS fuzz TIMEOUT ${timeout})
endfunction()
