#include "../mpi/started_by_mpirun.h"
#include "command_main.h"
#include "exit_code.h"
#include "subcommands.h"

int main(int argc, char** argv) {
  if (const int code = abbe::become_one_of_several(argv); code != abbe::kDone) return code;
  return abbe::command_main(argc, argv, abbe::add_subcommands);
}
