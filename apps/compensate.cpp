#include "compensate/compensate.h"

#include "command.h"
#include "options.h"

namespace abbe {

void add_compensate_command(CommandLine& line) {
  Subcommand* command = line.add(
      "compensate", "Correct known errors: programs, tables for controls, real time, single poses",
      "  abbe compensate gcode examples/compensate/cone.ngc --machine "
      "examples/machines/trunnion-mill.machine.toml --errors "
      "examples/compensate/trunnion.errors.toml -o cone-corrected.ngc\n"
      "  abbe compensate table --machine examples/machines/three-axis-mill.machine.toml --errors "
      "examples/compensate/mill.errors.toml --for linuxcnc -o comp\n"
      "  abbe compensate kinematics --machine examples/machines/trunnion-mill.machine.toml --errors "
      "examples/compensate/trunnion.errors.toml --for siemens -o TRAFO5.INI\n"
      "  abbe compensate freeze --machine examples/machines/trunnion-mill.machine.toml --errors "
      "examples/trunnion/table.errors.toml -o mill.abbec\n"
      "  abbe compensate poses examples/compensate/poses.csv --machine examples/machines/trunnion-mill.machine.toml "
      "--errors examples/compensate/trunnion.errors.toml --dry-run\n\n"
      "abbe compensate gcode --help explains what X, Y and Z mean; abbe compensate table --help lists the controls.");
  command->require_subcommand(1);
  add_compensate_freeze(*command, line);
  add_compensate_gcode(*command, line);
  add_compensate_poses(*command, line);
  add_compensate_kinematics(*command, line);
  add_compensate_table(*command, line);
}

}  // namespace abbe
