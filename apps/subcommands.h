#pragma once

#include "command.h"

namespace abbe {

/// All subcommands, in the order of --help.
void add_subcommands(CommandLine& line);

}  // namespace abbe
