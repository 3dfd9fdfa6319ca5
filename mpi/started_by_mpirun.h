#pragma once

namespace abbe {

/// Where mpirun has started several processes of `abbe`: goes on as abbe-mpi, the program that shares the work out. If
/// that is missing, the first process says so.
/// @param argv  of main()
/// @returns an ExitCode: kDone if there is nothing to do, or else what the process is to end with
int become_one_of_several(char* const* argv);

}  // namespace abbe
