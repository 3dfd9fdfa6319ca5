# What a wheel brings besides the module (pyproject.toml): the command and its companion beside it in the folder of scripts,
# and where both look for them, the data that `abbe reproduce` recomputes. Linked as the module is: of the system they need the
# C and C++ libraries only.
set_target_properties(abbe abbe-papers PROPERTIES ABBE_STATIC ON)
install(TARGETS abbe abbe-papers RUNTIME DESTINATION ${SKBUILD_SCRIPTS_DIR} COMPONENT python)
set(abbe_wheel_data ${SKBUILD_DATA_DIR}/share/abbe)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples DESTINATION ${abbe_wheel_data} COMPONENT python
  PATTERN closed_loop EXCLUDE PATTERN thermal_day EXCLUDE)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/tests/golden/aguado ${PROJECT_SOURCE_DIR}/tests/golden/liu
    ${PROJECT_SOURCE_DIR}/tests/golden/ma ${PROJECT_SOURCE_DIR}/tests/golden/yin
  DESTINATION ${abbe_wheel_data}/golden COMPONENT python FILES_MATCHING PATTERN "*.csv" PATTERN "*.json")
