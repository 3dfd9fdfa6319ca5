#include "machine_options.h"

#include "options.h"

namespace abbe {

Option* add_machine(Subcommand& command, std::string& file, const std::string& description) {
  return command.add_input_file("--machine", file, description);
}

Option* add_errors(Subcommand& command, std::string& file, const std::string& description) {
  return command.add_input_file("--errors", file, description);
}

void add_machine_and_errors(Subcommand& command, std::string& machine, std::string& errors) {
  command.take_from_arguments({add_machine(command, machine)->required(), add_errors(command, errors)->required()});
}

}  // namespace abbe
