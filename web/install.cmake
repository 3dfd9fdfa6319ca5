# install_packages(WEB PRIVATE SHARED RESULT): the packages of the page exactly as locked, once per clone.
#
# RESULT becomes the folder that holds sources and packages: WEB; or, where the source tree cannot be written to (or SHARED is
# false: nobody keeps other builds away) and has no packages, a copy of WEB in PRIVATE. Does nothing when the packages are
# there already, so that it works offline.
function(packages_are_there folder result)
  set(there FALSE)
  file(SHA256 ${folder}/package-lock.json locked)
  set(stamp ${folder}/node_modules/.abbe-lock)
  set(npms_own ${folder}/node_modules/.package-lock.json)  # npm writes it last
  if(EXISTS ${stamp} AND EXISTS ${npms_own})
    file(READ ${stamp} installed)
    if(installed STREQUAL locked)
      set(there TRUE)
    endif()
  elseif(EXISTS ${npms_own} AND NOT ${folder}/package-lock.json IS_NEWER_THAN ${npms_own})
    set(there TRUE)  # somebody ran `npm ci`
  endif()
  set(${result} ${there} PARENT_SCOPE)
endfunction()

function(install_packages web private shared result)
  set(root ${web})
  packages_are_there(${root} there)
  if(NOT there)
    set(writable 1)
    if(shared)
      execute_process(COMMAND ${CMAKE_COMMAND} -E make_directory ${web}/node_modules
        RESULT_VARIABLE writable OUTPUT_QUIET ERROR_QUIET)
    endif()
    if(writable EQUAL 0)
      execute_process(COMMAND ${CMAKE_COMMAND} -E touch ${web}/node_modules/.abbe-try
        RESULT_VARIABLE writable OUTPUT_QUIET ERROR_QUIET)
    endif()
    if(NOT writable EQUAL 0)
      set(root ${private}/web)
      file(COPY ${web}/ DESTINATION ${root} NO_SOURCE_PERMISSIONS PATTERN node_modules EXCLUDE)
      packages_are_there(${root} there)
    endif()
  endif()
  if(NOT there)
    execute_process(COMMAND ${NPM} ci --ignore-scripts --no-audit --no-fund --prefer-offline WORKING_DIRECTORY ${root}
      RESULT_VARIABLE failed OUTPUT_VARIABLE text ERROR_VARIABLE text)
    if(NOT failed EQUAL 0)
      message(FATAL_ERROR "npm ci failed in ${root} (the report page needs its packages once):\n${text}")
    endif()
    file(SHA256 ${root}/package-lock.json locked)
    file(WRITE ${root}/node_modules/.abbe-lock ${locked})
  endif()
  set(${result} ${root} PARENT_SCOPE)
endfunction()
