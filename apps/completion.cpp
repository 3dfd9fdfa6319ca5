#include "completion/completion.h"

#include "command.h"
#include "exit_code.h"
#include "messages.h"
#include "options.h"

namespace abbe {

void add_completion_command(CommandLine& line) {
  auto shell = std::make_shared<std::string>();
  Subcommand* command = line.add("completion", "Print the completion of the command line for a shell",
                                 "  source <(abbe completion bash)");
  command->add_option("shell", *shell, "bash, zsh or fish")->required()->check(one_of({"bash", "zsh", "fish"}));
  command->callback([&line, shell] {
    line.run = [&line, shell]() -> int {
      const CommandDescription program = line.program.describe();
      print_file(*shell == "bash"  ? bash_completion(program)
                 : *shell == "zsh" ? zsh_completion(program)
                                   : fish_completion(program));
      return kDone;
    };
  });
}

}  // namespace abbe
