# The page of the report as HTML and as C++ text, made once per clone and copied into every build folder that asks.
#   cmake -DWEB=<web folder> -DNODE=<node> -DNPM=<npm> -DSHARED=<folder of the clone> -DOUT=<folder of the build> -P page.cmake
#
# SHARED holds one page, in a folder named for its sources' contents. Whoever works in SHARED or in WEB holds a lock, so build
# folders can be built at the same time. Where SHARED cannot be written to, everything happens in OUT. Writes OUT/page.d, what
# the page depends on, for ninja.
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/install.cmake)

file(GLOB_RECURSE sources LIST_DIRECTORIES true ${WEB}/src/*)
list(APPEND sources ${WEB}/src)  # a folder is younger when a file has come or gone
set(others ${WEB}/build.mjs ${WEB}/tsconfig.json ${WEB}/package.json ${WEB}/package-lock.json)

function(key_of_sources result)
  set(text "")
  foreach(source IN LISTS sources others)
    if(NOT IS_DIRECTORY ${source})
      file(SHA256 ${source} hash)
      file(RELATIVE_PATH name ${WEB} ${source})
      string(APPEND text "${name} ${hash}\n")
    endif()
  endforeach()
  string(SHA256 key "${text}")
  string(SUBSTRING ${key} 0 16 key)
  set(${result} ${key} PARENT_SCOPE)
endfunction()

set(lock 1)
execute_process(COMMAND ${CMAKE_COMMAND} -E make_directory ${SHARED} RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
if(failed EQUAL 0)
  execute_process(COMMAND ${CMAKE_COMMAND} -E touch ${SHARED}/lock RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
endif()
if(failed EQUAL 0)
  file(LOCK ${SHARED}/lock TIMEOUT 1200 RESULT_VARIABLE lock)
endif()
if(lock EQUAL 0)
  set(shared TRUE)
  set(store ${SHARED})
else()
  set(shared FALSE)
  set(store ${OUT}/page)
endif()

install_packages(${WEB} ${OUT} ${shared} root)
key_of_sources(key)
set(page ${store}/${key})
if(NOT EXISTS ${page}/report.html OR NOT EXISTS ${page}/page_template.cpp)
  file(GLOB old ${store}/*)
  list(REMOVE_ITEM old ${store}/lock)
  if(old)
    file(REMOVE_RECURSE ${old})
  endif()
  execute_process(COMMAND ${NODE} ${root}/build.mjs --html ${store}/new/report.html --cpp ${store}/new/page_template.cpp
    RESULT_VARIABLE failed OUTPUT_QUIET)
  if(NOT failed EQUAL 0)
    message(FATAL_ERROR "The page of the report could not be made.")
  endif()
  key_of_sources(key_afterwards)
  if(key STREQUAL key_afterwards)
    file(RENAME ${store}/new ${page})
  else()
    set(page ${store}/new)  # a source was changed meanwhile: good for this build, which ninja repeats, and for no other
  endif()
endif()
foreach(name report.html page_template.cpp)
  file(COPY_FILE ${page}/${name} ${OUT}/${name} ONLY_IF_DIFFERENT)
endforeach()

list(TRANSFORM sources REPLACE " " "\\\\ ")
list(JOIN sources " \\\n  " sources)
string(REPLACE " " "\\ " target ${OUT}/report.html)
file(WRITE ${OUT}/page.d "${target}: ${sources}\n")
