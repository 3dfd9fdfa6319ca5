# For an sdist, which `python -m build --sdist` makes (pyproject.toml), CMake is configured in the source tree for nothing but
# this: the page of the report, in web/dist, is made beforehand, so that the sdist needs neither Node.js nor the network
# (src/abbe/report/CMakeLists.txt).
include(AbbeNode)
execute_process(COMMAND ${CMAKE_COMMAND} -DWEB=${PROJECT_SOURCE_DIR}/web -DNODE=${ABBE_NODE} -DNPM=${ABBE_NPM}
    -DSHARED=${PROJECT_SOURCE_DIR}/build/web -DOUT=${CMAKE_CURRENT_BINARY_DIR} -P ${PROJECT_SOURCE_DIR}/web/page.cmake
  COMMAND_ERROR_IS_FATAL ANY)
file(COPY ${CMAKE_CURRENT_BINARY_DIR}/report.html ${CMAKE_CURRENT_BINARY_DIR}/page_template.cpp
  DESTINATION ${PROJECT_SOURCE_DIR}/web/dist)
