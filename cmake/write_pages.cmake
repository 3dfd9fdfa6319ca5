# cmake -DABBE=... -DSOURCE=... -DOUT=... -P write_pages.cmake: manual pages and completions in OUT, as the command writes
# them of its own options; pages are compressed as Debian's policy asks.
file(REMOVE_RECURSE ${OUT})
file(MAKE_DIRECTORY ${OUT}/man1 ${OUT}/completion)
execute_process(COMMAND ${ABBE} man --list OUTPUT_VARIABLE names COMMAND_ERROR_IS_FATAL ANY)
string(STRIP "${names}" names)
string(REPLACE "\n" ";" names "${names}")
foreach(name IN LISTS names)
  string(REGEX REPLACE "^abbe-?" "" command ${name})
  execute_process(COMMAND ${ABBE} man ${command} OUTPUT_FILE ${OUT}/man1/${name}.1 COMMAND_ERROR_IS_FATAL ANY)
endforeach()
# abbe-papers is what `abbe reproduce` starts, with its options.
file(WRITE ${OUT}/man1/abbe-papers.1 ".so man1/abbe-reproduce.1\n")
file(COPY ${SOURCE}/packaging/abbe-step.1 DESTINATION ${OUT}/man1)
file(GLOB pages ${OUT}/man1/*.1)
execute_process(COMMAND gzip -9n ${pages} COMMAND_ERROR_IS_FATAL ANY)
foreach(shell IN ITEMS bash zsh fish)
  execute_process(COMMAND ${ABBE} completion ${shell} OUTPUT_FILE ${OUT}/completion/${shell} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
