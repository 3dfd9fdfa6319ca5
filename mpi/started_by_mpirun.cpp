#include "started_by_mpirun.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "abbe/formats/files/companion_program.h"
#include "exit_code.h"
#include "messages.h"

namespace abbe {
namespace {

constexpr CompanionProgram kMpiProgram{"abbe-mpi", "ABBE_MPI_PROGRAM"};

/// As Open MPI tells its processes.
int number_in(const char* variable) {
  const char* const value = std::getenv(variable);
  return value == nullptr ? 0 : std::atoi(value);
}

}  // namespace

int become_one_of_several(char* const* argv) {
  const int processes = number_in("OMPI_COMM_WORLD_SIZE");
  if (processes < 2) return kDone;
  try {
    const std::filesystem::path program = find_companion_program(kMpiProgram);
    if (program.empty()) {
      throw InputError(
          {.file = kMpiProgram.name},
          fmt::format("mpirun has started {} processes, and this program, which shares the work, is missing",
                      processes),
          fmt::format("it at {} (built where CMake finds MPI), or its name in the environment variable {}",
                      path_beside_this_program(kMpiProgram).string(), kMpiProgram.variable));
    }
    ::execv(program.c_str(), argv);
    throw InputError({.file = program.string()}, fmt::format("cannot be started: {}", std::strerror(errno)),
                     fmt::format("the program {}", kMpiProgram.name));
  } catch (const InputError& error) {
    if (number_in("OMPI_COMM_WORLD_RANK") == 0) tell("abbe: {}\n", error.what());
    return kBadInput;
  }
}

}  // namespace abbe
