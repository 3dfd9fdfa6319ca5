# How sources become translation units: several in one, and with the headers that nearly all of them need parsed once.
#
# Most of the time of a unit is spent on Eigen and the standard library: on parsing them and on instantiating the same
# templates again. With ABBE_UNITY (default) the sources of a target are compiled in batches, in the order in which they
# are listed; with ABBE_PRECOMPILE (default) what cmake/precompiled*.h include is compiled beforehand. Without both, as
# clang-tidy and editors want it, every source is a unit of its own.
option(ABBE_UNITY "Compile several sources in one unit" ON)
option(ABBE_PRECOMPILE "Precompile the headers that most sources need" ON)
option(ABBE_QUICK_BUILD "Do not optimise what computes little, which halves the time to compile it" OFF)
set(ABBE_BATCH 8 CACHE STRING "Sources in one unit")

# abbe_units(TARGET ROOT SOURCES a.cpp ... [ALONE b.cpp ...] [FAST pattern] [PRECOMPILED header target]): the sources of an
# existing target.
#
# ROOT is the include folder from which batches include the sources: paths of a clone do not get into the units, so that
# ccache finds them in another clone. ALONE are sources that cannot share a unit: those that include themselves for every
# instruction set (Highway), those compiled with options of their own, and those with a header that no other unit should
# have to parse. FAST is a regular expression for the sources that optimised builds compile with -O3, which makes kernels up
# to 1.8 times as fast as -O2 does (docs/performance.md). They have their own units and their own precompiled header: with a
# header that was compiled with -O2, GCC accepts -O3 but inlines as with -O2, and instruments take 1.4 times as long.
function(abbe_units target root)
  cmake_parse_arguments(ARG "" "PRECOMPILED;FAST" "SOURCES;ALONE" ${ARGN})
  set(number 0)
  set(fast "")
  if(ARG_FAST)
    set(fast ${ARG_SOURCES})
    list(FILTER fast INCLUDE REGEX "${ARG_FAST}")
    list(REMOVE_ITEM ARG_SOURCES ${fast})
  endif()
  foreach(sources ARG_SOURCES fast)
    set(batch "")
    set(count 0)
    foreach(source IN LISTS ${sources})
      get_filename_component(path ${source} ABSOLUTE)
      file(RELATIVE_PATH name ${root} ${path})
      if(NOT ABBE_UNITY OR source IN_LIST ARG_ALONE OR name MATCHES "^\\.\\." OR NOT EXISTS ${path})
        target_sources(${target} PRIVATE ${source})
        if("${sources}" STREQUAL "fast")
          abbe_compile_fast(${source} "${ARG_ALONE}" "${ARG_PRECOMPILED}")
        endif()
        continue()
      endif()
      string(APPEND batch "#include \"${name}\"\n")
      set_source_files_properties(${source} PROPERTIES HEADER_FILE_ONLY ON)
      math(EXPR count "${count} + 1")
      if(count EQUAL ABBE_BATCH)
        abbe_write_batch(${target} ${number} "${batch}" ${sources} "${ARG_PRECOMPILED}")
        set(batch "")
        set(count 0)
        math(EXPR number "${number} + 1")
      endif()
    endforeach()
    if(batch)
      abbe_write_batch(${target} ${number} "${batch}" ${sources} "${ARG_PRECOMPILED}")
      math(EXPR number "${number} + 1")
    endif()
  endforeach()
  if(ABBE_PRECOMPILE AND ARG_PRECOMPILED)
    target_precompile_headers(${target} REUSE_FROM ${ARG_PRECOMPILED})
    set_source_files_properties(${ARG_ALONE} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
  endif()
endfunction()

# kind: "fast", or anything else. precompiled: of the target.
function(abbe_write_batch target number content kind precompiled)
  set(file ${CMAKE_CURRENT_BINARY_DIR}/${target}_${number}.cpp)
  file(CONFIGURE OUTPUT ${file} CONTENT "${content}" @ONLY)
  target_sources(${target} PRIVATE ${file})
  if(kind STREQUAL "fast")
    abbe_compile_fast(${file} "" "${precompiled}")
  endif()
endfunction()

# A source that optimised builds compile with -O3. `alone`: sources that take no precompiled header. `precompiled`: that of the
# target.
function(abbe_compile_fast source alone precompiled)
  set(options $<$<CONFIG:Release>:-O3>)
  if(precompiled STREQUAL abbe_little_precompiled)
    # The precompiled header of the target was not optimised, which clang does not accept here.
    list(APPEND options -O1)
    set_source_files_properties(${source} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
    if(ABBE_PRECOMPILE AND CMAKE_CXX_COMPILER_ID STREQUAL "Clang" AND NOT source IN_LIST alone)
      set(header ${PROJECT_BINARY_DIR}/CMakeFiles/abbe_precompiled.dir/cmake_pch.hxx.pch)
      list(APPEND options -include-pch ${header})
      set_source_files_properties(${source} PROPERTIES OBJECT_DEPENDS ${header})
    endif()
  elseif(TARGET abbe_precompiled_fast AND NOT source IN_LIST alone)
    set(header ${PROJECT_BINARY_DIR}/CMakeFiles/abbe_precompiled_fast.dir/cmake_pch.hxx)
    list(APPEND options -Winvalid-pch -include ${header})
    set_source_files_properties(${source} PROPERTIES SKIP_PRECOMPILE_HEADERS ON OBJECT_DEPENDS ${header}.gch)
  endif()
  set_property(SOURCE ${source} APPEND PROPERTY COMPILE_OPTIONS ${options})
endfunction()

# abbe_link_optimised_first(TARGET SCOPE NAME...): of the folders NAME of src/abbe, those that are optimised are linked first and
# whole with a target that is not. Of functions of templates that both have, the linker takes the first.
function(abbe_link_optimised_first target scope)
  foreach(name IN LISTS ARGN)
    get_target_property(type abbe_${name} TYPE)
    get_target_property(little abbe_${name} ABBE_COMPUTES_LITTLE)
    if(type STREQUAL STATIC_LIBRARY AND NOT little)
      # The same words wherever they are asked for, so that CMake names each archive once.
      target_link_options(${target} ${scope}
        $<BUILD_INTERFACE:LINKER:--push-state,--whole-archive,$<TARGET_FILE:abbe_${name}>,--pop-state>)
    endif()
  endforeach()
endfunction()

# abbe_test_units(TARGET ROOT SOURCES a_test.cpp ... [ALONE b_test.cpp ...] [COMPUTES_LITTLE] [LIBRARIES study ...]): the
# sources of a test program.
#
# COMPUTES_LITTLE: compiled without optimisation (AbbeFlags.cmake); LIBRARIES, the folders of src/abbe that the program uses.
function(abbe_test_units target root)
  cmake_parse_arguments(ARG "COMPUTES_LITTLE" "" "SOURCES;ALONE;LIBRARIES" ${ARGN})
  set(precompiled abbe_test_precompiled)
  if(ARG_COMPUTES_LITTLE)
    set(precompiled abbe_little_test_precompiled)
    set_target_properties(${target} PROPERTIES ABBE_COMPUTES_LITTLE ON)
    abbe_link_optimised_first(${target} PRIVATE ${ARG_LIBRARIES})
  endif()
  abbe_units(${target} ${root} SOURCES ${ARG_SOURCES} ALONE ${ARG_ALONE} PRECOMPILED ${precompiled})
endfunction()

# abbe_precompiled(NAME HEADER FLAGS LINK ... [INDEPENDENT] [FAST]): a target from which others reuse precompiled headers.
# FLAGS: abbe_flags or abbe_test_flags, as theirs. INDEPENDENT: for libraries, whose code does not depend on its position; the
# compiler wants it equal. FAST: compiled with -O3.
function(abbe_precompiled name header flags)
  cmake_parse_arguments(ARG "INDEPENDENT;FAST" "" "LINK" ${ARGN})
  if(NOT ABBE_PRECOMPILE)
    return()
  endif()
  set(empty ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  file(CONFIGURE OUTPUT ${empty} CONTENT "" @ONLY)
  add_library(${name} OBJECT ${empty})
  target_compile_features(${name} PRIVATE cxx_std_20)
  target_link_libraries(${name} PRIVATE ${flags} ${ARG_LINK})
  if(ARG_INDEPENDENT)
    set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  endif()
  if(ARG_FAST)
    target_compile_options(${name} PRIVATE -O3)
  endif()
  target_precompile_headers(${name} PRIVATE ${PROJECT_SOURCE_DIR}/cmake/${header})
endfunction()
