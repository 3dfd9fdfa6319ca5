#include "command.h"
#include "command_main.h"
#include "compensate/compensate.h"
#include "scan/scan.h"

namespace abbe {
namespace {

void add_subcommands(CommandLine& line) {
  add_run_command(line);
  add_new_command(line);
  add_check_command(line);
  add_simulate_command(line);
  add_plan_command(line);
  add_identify_command(line);
  add_map_command(line);
  add_path_command(line);
  add_test_piece_command(line);
  add_compensate_command(line);
  add_verify_command(line);
  add_position_command(line);
  add_fit_command(line);
  add_evaluate_command(line);
  add_register_command(line);
  add_deviate_command(line);
  add_reproduce_command(line);
  add_scan_command(line);
}

}  // namespace
}  // namespace abbe

int main(int argc, char** argv) { return abbe::command_main(argc, argv, abbe::add_subcommands); }
