#include "scan/scan.h"

#include "command.h"
#include "options.h"

namespace abbe {

void add_scan_command(CommandLine& line) {
  Subcommand* command = line.add(
      "scan", "Plan scans with a displacement probe, and turn readings into points",
      "  abbe scan points examples/cradle_scanner/readings.csv --machine examples/machines/liu-scanner.machine.toml -o "
      "p.ply\n"
      "  abbe scan plan examples/cradle_scanner/pyramid.stl --machine examples/machines/liu-scanner.machine.toml -o "
      "pyramid-path.csv\n\n"
      "abbe scan points --help describes the readings.");
  command->require_subcommand(1);
  add_scan_plan(*command, line);
  add_scan_points(*command, line);
}

}  // namespace abbe
