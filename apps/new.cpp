#include <fmt/format.h>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/machine/machine_file.h"
#include "command.h"
#include "exit_code.h"
#include "messages.h"
#include "options.h"

namespace abbe {

void add_new_command(CommandLine& line) {
  struct Options {
    std::string chain, output;
  };
  auto options = std::make_shared<Options>();
  Subcommand* command =
      line.add("new", "Write a commented machine file from a chain",
               "  abbe new \"w C' A' Y' b X Z t\" -o my_mill.machine.toml\n\n"
               "The chain runs from the workpiece (w) over the bed (b) to the tool (t), axes in ISO 841 letters; "
               "a prime\nmarks an axis that carries the workpiece.");
  command->add_option("chain", options->chain, "Chain, for example \"w C' X' b Z t\"")->required();
  command->add_output_file("-o,--output", options->output, "File to write (default: standard output)");
  command->callback([&line, options] {
    line.run = [options]() -> int {
      const std::string text = commented_machine_file(options->chain);
      if (options->output.empty()) {
        print_file(text);
        return kDone;
      }
      write_file_atomically(options->output, text);
      fmt::print("{} written; edit it, then: abbe check --machine {}\n", options->output, options->output);
      return kDone;
    };
  });
}

}  // namespace abbe
