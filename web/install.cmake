# Installs the packages of web/ exactly as locked; does nothing when they are there already, so that it works offline.
#   cmake -DWEB=<web folder> -DNPM=<npm> -DSTAMP=<file> -P install.cmake
set(installed ${WEB}/node_modules/.package-lock.json)
if(NOT EXISTS ${installed} OR ${WEB}/package-lock.json IS_NEWER_THAN ${installed})
  execute_process(COMMAND ${NPM} ci --ignore-scripts --no-audit --no-fund WORKING_DIRECTORY ${WEB}
    RESULT_VARIABLE result OUTPUT_VARIABLE text ERROR_VARIABLE text)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "npm ci failed in web/ (the report page needs its packages once):\n${text}")
  endif()
  file(TOUCH ${installed})
endif()
file(TOUCH ${STAMP})
