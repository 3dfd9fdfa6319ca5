# Warnings, sanitizers and coverage, for the project's own targets only.
add_library(abbe_flags INTERFACE)
target_compile_options(abbe_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wnon-virtual-dtor -Woverloaded-virtual
  # The same bits on every machine and at every optimisation level.
  -ffp-contract=off
  $<$<BOOL:${ABBE_WERROR}>:-Werror>)
if(ABBE_SANITIZE)
  target_compile_options(abbe_flags INTERFACE -fsanitize=${ABBE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(abbe_flags INTERFACE -fsanitize=${ABBE_SANITIZE})
endif()
if(ABBE_FUZZ)
  target_compile_options(abbe_flags INTERFACE -fsanitize=fuzzer-no-link)
  target_link_options(abbe_flags INTERFACE -fsanitize=fuzzer-no-link)
endif()
if(ABBE_COVERAGE)
  target_compile_options(abbe_flags INTERFACE --coverage)
  target_link_options(abbe_flags INTERFACE --coverage)
endif()
