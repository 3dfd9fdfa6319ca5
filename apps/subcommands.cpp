#include "subcommands.h"

#include "compensate/compensate.h"
#include "scan/scan.h"

namespace abbe {

void add_subcommands(CommandLine& line) {
  line.begin_section("Whole studies");
  add_run_command(line);
  add_reproduce_command(line);
  line.begin_section("Machines");
  add_new_command(line);
  add_check_command(line);
  line.begin_section("Measure");
  add_plan_command(line);
  add_program_command(line);
  add_simulate_command(line);
  add_scan_command(line);
  add_position_command(line);
  add_import_command(line);
  line.begin_section("Identify");
  add_identify_command(line);
  add_map_command(line);
  add_compare_command(line);
  add_history_command(line);
  line.begin_section("Evaluate");
  add_evaluate_command(line);
  line.begin_section("Compensate");
  add_compensate_command(line);
  add_path_command(line);
  line.begin_section("Verify");
  add_verify_command(line);
  add_test_piece_command(line);
  line.begin_section("Shapes");
  add_fit_command(line);
  add_register_command(line);
  add_deviate_command(line);
  // For those who make packages, and for shells.
  line.begin_section("");
  add_completion_command(line);
  add_man_command(line);
}

}  // namespace abbe
