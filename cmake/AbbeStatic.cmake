# Programs without shared libraries, for the tarball that runs on any Linux, whatever its C library. They are linked from
# the libraries of the same build. `abbe_static` builds all of them; nothing else needs them.
#
# Debian has fmt and Highway as shared libraries only. What the programs need of them is compiled here: fmt from its own
# headers, and of Highway the two functions that choose among the processors it was compiled for. Libraries link
# abbe_fmt and abbe_highway, which are one or the other, depending on the program that is linked.
set(ABBE_STATIC_DIRECTORY ${CMAKE_BINARY_DIR}/static/bin)
add_custom_target(abbe_static)
function(abbe_either_library name static shared source)
  add_library(${static} STATIC EXCLUDE_FROM_ALL ${PROJECT_SOURCE_DIR}/packaging/static/${source})
  target_compile_features(${static} PRIVATE cxx_std_20)
  target_include_directories(${static} SYSTEM PRIVATE $<TARGET_PROPERTY:${shared},INTERFACE_INCLUDE_DIRECTORIES>)
  set_target_properties(${static} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  add_library(${name} INTERFACE)
  target_link_libraries(${name} INTERFACE $<IF:$<BOOL:$<TARGET_PROPERTY:ABBE_STATIC>>,${static},${shared}>)
endfunction()
abbe_either_library(abbe_fmt abbe_static_fmt fmt::fmt fmt.cpp)
abbe_either_library(abbe_highway abbe_static_highway hwy::hwy highway.cpp)
# The static libraries of zlib, Expat and SQLite are in the same packages as the shared ones; on other systems they may be missing.
function(abbe_static_archive name shared archive libraries include_folders)
  string(TOUPPER "ABBE_STATIC_${archive}" variable)
  list(GET libraries 0 first)
  get_filename_component(folder "${first}" DIRECTORY)
  find_library(${variable} ${archive}.a HINTS "${folder}")
  mark_as_advanced(${variable})
  set(static ${shared})
  if(${variable})
    set(static ${${variable}})
  endif()
  add_library(${name} INTERFACE)
  target_include_directories(${name} SYSTEM INTERFACE ${include_folders})
  target_link_libraries(${name} INTERFACE $<IF:$<BOOL:$<TARGET_PROPERTY:ABBE_STATIC>>,${static},${shared}>)
endfunction()
abbe_static_archive(abbe_zlib ZLIB::ZLIB libz "${ZLIB_LIBRARIES}" "${ZLIB_INCLUDE_DIRS}")
abbe_static_archive(abbe_expat EXPAT::EXPAT libexpat "${EXPAT_LIBRARIES}" "${EXPAT_INCLUDE_DIRS}")
abbe_static_archive(abbe_sqlite SQLite::SQLite3 libsqlite3 "${SQLite3_LIBRARIES}" "${SQLite3_INCLUDE_DIRS}")

# abbe_static_program(NAME SOURCE LIBRARY): NAME linked statically, as a target abbe_static_NAME. Its addresses are chosen at
# each start, as those of other programs.
function(abbe_static_program name source library)
  string(REPLACE "-" "_" target abbe_static_${name})
  add_executable(${target} EXCLUDE_FROM_ALL ${source})
  target_link_libraries(${target} PRIVATE abbe_flags ${library})
  target_link_options(${target} PRIVATE -static-pie -s)
  set_target_properties(${target} PROPERTIES ABBE_STATIC ON POSITION_INDEPENDENT_CODE ON
    OUTPUT_NAME ${name} RUNTIME_OUTPUT_DIRECTORY ${ABBE_STATIC_DIRECTORY})
  add_dependencies(abbe_static ${target})
endfunction()
