# Warnings, sanitizers and coverage, for the project's own targets only.
add_library(abbe_flags INTERFACE)
target_compile_options(abbe_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wnon-virtual-dtor -Woverloaded-virtual
  # clang counts changes of sign as conversions, GCC does not; Eigen's signed indices make them noise.
  $<$<CXX_COMPILER_ID:Clang>:-Wno-sign-conversion>
  # In a batch of sources (AbbeUnits.cmake) none of them is the main file, to which this warning leaves unnamed namespaces.
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<BOOL:${ABBE_UNITY}>>:-Wno-subobject-linkage>
  # Nor does a local name hide one of another source; GCC and the units of single sources keep the warning.
  $<$<AND:$<CXX_COMPILER_ID:Clang>,$<BOOL:${ABBE_UNITY}>>:-Wno-shadow>
  # False alarms of GCC 12 on strings that are put together (its bugs 105329 and 105651).
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-array-bounds;-Wno-restrict>
  # The same bits on every machine and at every optimisation level.
  -ffp-contract=off
  $<$<BOOL:${ABBE_WERROR}>:-Werror>)
# The same for all, so that all can share precompiled headers.
target_compile_definitions(abbe_flags INTERFACE $<TARGET_PROPERTY:fmt::fmt,INTERFACE_COMPILE_DEFINITIONS>)
if(ABBE_SANITIZE)
  target_compile_options(abbe_flags INTERFACE -fsanitize=${ABBE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(abbe_flags INTERFACE -fsanitize=${ABBE_SANITIZE})
endif()
if(ABBE_FUZZ)
  target_compile_options(abbe_flags INTERFACE -fsanitize=fuzzer-no-link)
  target_link_options(abbe_flags INTERFACE -fsanitize=fuzzer-no-link)
endif()
if(ABBE_SANITIZE OR ABBE_FUZZ OR CMAKE_CXX_CLANG_TIDY)
  # One processor generation is enough to find mistakes, and instrumented kernels for all of them take minutes to compile.
  target_compile_definitions(abbe_flags INTERFACE HWY_COMPILE_ONLY_STATIC)
endif()
if(ABBE_COVERAGE)
  # Counters of threads are added up, not overwritten: else lines of parallel loops get negative counts.
  target_compile_options(abbe_flags INTERFACE --coverage -fprofile-update=atomic)
  target_link_options(abbe_flags INTERFACE --coverage)
endif()
