# ABBE_NODE and ABBE_NPM, with which the page of the report is made.
find_program(ABBE_NODE NAMES node nodejs)
find_program(ABBE_NPM NAMES npm)
if(NOT ABBE_NODE OR NOT ABBE_NPM)
  message(FATAL_ERROR "The report page is built with Node.js 18 or newer and npm, and one of them is missing.\n"
                      "Debian: apt-get install nodejs npm. Elsewhere: set ABBE_NODE and ABBE_NPM.")
endif()
execute_process(COMMAND ${ABBE_NODE} --version OUTPUT_VARIABLE node_version OUTPUT_STRIP_TRAILING_WHITESPACE)
string(REGEX REPLACE "^v" "" node_version "${node_version}")
if(node_version VERSION_LESS 18)
  message(FATAL_ERROR "Node.js 18 or newer is needed for the report page; ${ABBE_NODE} is ${node_version}.")
endif()
