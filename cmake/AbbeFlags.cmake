# Warnings, sanitizers and coverage, for the project's own targets only: abbe_flags for the libraries and programs,
# abbe_test_flags for the tests, abbe_common_flags for both.
add_library(abbe_common_flags INTERFACE)
add_library(abbe_flags INTERFACE)
add_library(abbe_test_flags INTERFACE)
target_link_libraries(abbe_flags INTERFACE abbe_common_flags)
target_link_libraries(abbe_test_flags INTERFACE abbe_common_flags)
if(ABBE_WARNINGS OR ABBE_WERROR)
  target_compile_options(abbe_common_flags INTERFACE
    -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wnon-virtual-dtor -Woverloaded-virtual
    # clang counts changes of sign as conversions, GCC does not; Eigen's signed indices make them noise.
    $<$<CXX_COMPILER_ID:Clang>:-Wno-sign-conversion>
    # In a batch of sources (AbbeUnits.cmake) none of them is the main file, to which this warning leaves unnamed namespaces.
    $<$<AND:$<CXX_COMPILER_ID:GNU>,$<BOOL:${ABBE_UNITY}>>:-Wno-subobject-linkage>
    # Nor does a local name hide one of another source; GCC and the units of single sources keep the warning.
    $<$<AND:$<CXX_COMPILER_ID:Clang>,$<BOOL:${ABBE_UNITY}>>:-Wno-shadow>
    # False alarms of GCC 12 on strings that are put together (its bugs 105329 and 105651).
    $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-array-bounds;-Wno-restrict;-Wno-stringop-overflow>
    # Nor does it know at -O1, with which the development build is compiled, what inlining would have told it.
    $<$<AND:$<CXX_COMPILER_ID:GNU>,$<CONFIG:RelWithDebInfo>>:-Wno-maybe-uninitialized>)
else()
  # Those of these that GCC gives unasked.
  target_compile_options(abbe_common_flags INTERFACE
    $<$<AND:$<CXX_COMPILER_ID:GNU>,$<BOOL:${ABBE_UNITY}>>:-Wno-subobject-linkage>
    $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-stringop-overflow>)
endif()
target_compile_options(abbe_common_flags INTERFACE
  # The same bits on every machine and at every optimisation level.
  -ffp-contract=off
  $<$<BOOL:${ABBE_WERROR}>:-Werror>
  # GCC starts to collect garbage early, which is a tenth of the time of a batch; batches stay below 2 GB without.
  $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=1000000>)
target_compile_options(abbe_flags INTERFACE $<$<BOOL:$<TARGET_PROPERTY:ABBE_COMPUTES_LITTLE>>:-O0>)
# Tests see the internal headers too.
target_include_directories(abbe_test_flags INTERFACE ${PROJECT_SOURCE_DIR}/src)
# The code of tests is compiled for one run. Where it computes little itself, it is not optimised: that takes a third to a
# half of the time. Tests of geometry, which compute much, take more than twice as long so.
set(abbe_of_test $<IF:$<BOOL:$<TARGET_PROPERTY:ABBE_COMPUTES_LITTLE>>,-O0,-O1>)
target_compile_options(abbe_test_flags INTERFACE $<$<NOT:$<CONFIG:Debug>>:${abbe_of_test}>)
# The same for all, so that all can share precompiled headers.
target_compile_definitions(abbe_common_flags INTERFACE $<TARGET_PROPERTY:fmt::fmt,INTERFACE_COMPILE_DEFINITIONS>)
if(ABBE_TESTS)
  # A source of the library is in thirty test programs. LLVM's linker links them in a fifth of the time of GNU ld.
  include(CheckLinkerFlag)
  check_linker_flag(CXX -fuse-ld=lld ABBE_HAS_LLD)
  target_link_options(abbe_common_flags INTERFACE $<$<BOOL:${ABBE_HAS_LLD}>:-fuse-ld=lld>)
endif()
if(ABBE_SANITIZE)
  target_compile_options(abbe_common_flags INTERFACE -fno-omit-frame-pointer)
  target_compile_options(abbe_flags INTERFACE -fsanitize=${ABBE_SANITIZE} -fno-sanitize-recover=all)
  target_link_options(abbe_common_flags INTERFACE -fsanitize=${ABBE_SANITIZE})
  if(ABBE_SANITIZE STREQUAL "address,undefined")
    # The address sanitizer reports accesses by null pointers and beyond objects too. Checking these, the alignment, the
    # dynamic type and the arithmetic of pointers at every access takes half of the time to compile.
    target_compile_options(abbe_flags INTERFACE -fno-sanitize=null,object-size,alignment,vptr,pointer-overflow)
    # Accesses are checked in a function and not in place: code is smaller, and compiled in three quarters of the time.
    target_compile_options(abbe_common_flags INTERFACE "SHELL:-mllvm -asan-instrumentation-with-call-threshold=0")
    target_compile_options(abbe_test_flags INTERFACE -fsanitize=address)
  else()
    target_compile_options(abbe_test_flags INTERFACE -fsanitize=${ABBE_SANITIZE} -fno-sanitize-recover=all)
  endif()
endif()
if(ABBE_FUZZ)
  target_compile_options(abbe_flags INTERFACE -fsanitize=fuzzer-no-link)
  target_link_options(abbe_common_flags INTERFACE -fsanitize=fuzzer-no-link)
endif()
if(ABBE_SANITIZE OR ABBE_FUZZ OR CMAKE_CXX_CLANG_TIDY)
  # One processor generation is enough to find mistakes, and instrumented kernels for all of them take minutes to compile.
  target_compile_definitions(abbe_common_flags INTERFACE HWY_COMPILE_ONLY_STATIC)
endif()
if(ABBE_COVERAGE)
  # Counters of threads are added up, not overwritten: else lines of parallel loops get negative counts.
  target_compile_options(abbe_common_flags INTERFACE --coverage -fprofile-update=atomic)
  target_link_options(abbe_common_flags INTERFACE --coverage)
endif()
