# abbe_discover_tests(PROGRAM PREFIX LABEL TIMEOUT): the tests of a GoogleTest program in ctest. LABEL: unit, quick or long.
#
# Each test is one of ctest's and runs in a process of its own. Under the sanitizers, where a process takes a tenth of a second
# to start, the program is run as a whole, in ABBE_SHARDS parts, of which ctest runs several at a time.
set(ABBE_SHARDS 0 CACHE STRING "0: each test is one of ctest's; else the parts in which a test program is run")

# What `make test` builds with the sanitizers: the programs for fuzzing, which run the readers of all files, and the tests of
# what serves a controller. `make sanitize-libraries` adds the other libraries that read files or compute; `make sanitize`
# builds and runs everything.
add_custom_target(abbe_parts)
set(abbe_parts_prefixes errors. runtime.)
add_custom_target(abbe_libraries_tests)
set(abbe_libraries_prefixes
  compensate. controls. formats. geometry. history. identify. instruments. machine. plan. report. verify.)

# Programs that only `make long` builds and runs.
add_custom_target(abbe_long_programs)
function(abbe_long_program program)
  set_target_properties(${program} PROPERTIES EXCLUDE_FROM_ALL TRUE)
  add_dependencies(abbe_long_programs ${program})
endfunction()

# Repetitions by the hundred and long simulated programs: minutes each under the sanitizers, which see the same code in the
# other tests. All run in `make test` or `make long`.
set(abbe_not_sanitized
  DriftStudy.A* DriftStudy.TheIntensityOfAWalkIsEstimated
  FineRegistration.CovarianceIsThatOfManyRepetitions
  FitRivals.EveryRivalIsBetterThanAllShapesBesideIt
  LeastSquaresFit.CovarianceIsTheScatterOfManyFits
  OrderSelection.finds_the_number_of_intervals_of_splines_and_tables
  Programs/CompensatePrograms.TheToolFollowsAsLinuxCncReadsBoth/*
  RobustMonteCarlo.agrees_with_*
  WangBallBar.UncertaintyOfTheTraceIsThatOfItsScatterOverCampaigns
  YinMarks.OneFitOfMarksDeterminesAllSevenParametersBetterThanTheFiveSteps)

# Slow tests, with many repetitions, shapes or commands: two thirds of the time of all unit tests. `make quick` runs them;
# `make unit`, which is for every change, does not.
set(abbe_not_unit
  ChainPlanJacobian.* ComparedCampaigns.AKnownChange* ComparedCampaigns.WithoutAChange* DamagedStepFile.* DriftStudy.*
  EdgeSection.* EvaluationOfAContour.* FineRegistration.* FitRivals.* FitSimulation.* FrozenErrorsOfARequest.*
  LeastSquaresFit.CovarianceIs* LineTables.* LiuPlan.* MonteCarlo.* MoveSplitting.*
  MachineTrends.ErrorsThatStandStill* OrderSelection.* ProgramCorrection.* ProgramReversals.* Registration.*
  ResultsFolder.WritersKilled* RobustFit.* RobustMonteCarlo.* RuntimeTurns.* RuntimeUncertainty.*
  ScanRegistrationOfARequest.* StepFile.* UnexplainedReadings.* WangBallBar.* YinMarks.* YinResults.* YinSections.*)

# COST: long tests start first, so that the short ones fill up the processors at the end.
function(abbe_discover_tests program prefix label timeout)
  set(labels ${label})
  if(prefix IN_LIST abbe_parts_prefixes)
    add_dependencies(abbe_parts ${program})
    list(APPEND labels parts)
  elseif(prefix IN_LIST abbe_libraries_prefixes)
    add_dependencies(abbe_libraries_tests ${program})
    list(APPEND labels libraries)
  endif()
  if(NOT ABBE_SHARDS)
    if(label STREQUAL unit)
      list(JOIN abbe_not_unit ":" slow)
      gtest_discover_tests(${program} TEST_PREFIX "${prefix}" DISCOVERY_MODE PRE_TEST TEST_FILTER "${slow}"
        PROPERTIES LABELS quick TIMEOUT ${timeout} COST 5)
      set(filter TEST_FILTER "-${slow}")
    endif()
    set(cost 0)
    if(label STREQUAL long)
      set(cost 20)
    endif()
    gtest_discover_tests(${program} TEST_PREFIX "${prefix}" DISCOVERY_MODE PRE_TEST ${filter}
      PROPERTIES LABELS ${label} TIMEOUT ${timeout} COST ${cost})
    if(label STREQUAL long)
      # A program that is not built is one failing test, which is of the long ones too.
      set(labelled ${CMAKE_CURRENT_BINARY_DIR}/${program}_not_built.cmake)
      file(GENERATE OUTPUT ${labelled} CONTENT "if(NOT EXISTS \"$<TARGET_FILE:${program}>\")
  set_tests_properties(${program}_NOT_BUILT PROPERTIES LABELS long)
endif()
")
      set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${labelled})
    endif()
    return()
  endif()
  list(JOIN abbe_not_sanitized ":" left_out)
  math(EXPR last "${ABBE_SHARDS} - 1")
  foreach(shard RANGE ${last})
    set(name ${prefix}part_${shard})
    add_test(NAME ${name} COMMAND ${program} --gtest_brief=1)
    set_tests_properties(${name} PROPERTIES LABELS "${labels}" TIMEOUT 1200
      ENVIRONMENT "GTEST_TOTAL_SHARDS=${ABBE_SHARDS};GTEST_SHARD_INDEX=${shard};GTEST_FILTER=-${left_out}")
  endforeach()
endfunction()
