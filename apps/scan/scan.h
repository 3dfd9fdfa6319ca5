#pragma once

namespace CLI {
class App;
}

namespace abbe {

struct CommandLine;

void add_scan_command(CommandLine& line);
/// abbe scan plan: paths over the faces of a part.
void add_scan_plan(CLI::App& scan, CommandLine& line);
/// abbe scan points: axis positions and indications to points.
void add_scan_points(CLI::App& scan, CommandLine& line);

}  // namespace abbe
