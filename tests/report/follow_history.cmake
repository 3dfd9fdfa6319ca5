# Makes a history of the campaigns in examples/compare and its page: cmake -DABBE= -DEXAMPLES= -DOUT= -P follow_history.cmake
# An error of the last campaign is beyond its control limits, so the command ends with 1.
file(REMOVE_RECURSE ${OUT})
file(MAKE_DIRECTORY ${OUT})
set(compare ${EXAMPLES}/compare)
execute_process(COMMAND ${ABBE} history add ${OUT}/mill.history ${compare}/march.errors.toml ${compare}/june.errors.toml ${compare}/october.errors.toml
    --date 2026-03-02 --date 2026-06-01 --date 2026-10-05 --machine ${EXAMPLES}/machines/three-axis-mill.machine.toml
  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${ABBE} history trends ${OUT}/mill.history --limit-um 20 -o ${OUT}/page OUTPUT_QUIET RESULT_VARIABLE code)
if(NOT code EQUAL 1)
  message(FATAL_ERROR "abbe history trends ended with ${code} instead of 1")
endif()
file(RENAME ${OUT}/page/report.html ${OUT}/report.html)
