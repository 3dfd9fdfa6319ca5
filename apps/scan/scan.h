#pragma once

namespace abbe {

class Subcommand;
struct CommandLine;

void add_scan_command(CommandLine& line);
/// abbe scan plan: paths over the faces of a part.
void add_scan_plan(Subcommand& scan, CommandLine& line);
/// abbe scan points: axis positions and indications to points.
void add_scan_points(Subcommand& scan, CommandLine& line);

}  // namespace abbe
