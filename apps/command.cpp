#include "command.h"

#include "abbe/report/version.h"

namespace abbe {

CommandLine::CommandLine()
    : program("Geometric accuracy of multi-axis machines: model, identify, verify, report.", "abbe") {
  program.footer(
      "Examples:\n"
      "  abbe run examples/aguado/aguado.study.toml     the whole job, from readings to the report\n"
      "  abbe check --machine examples/machines/trunnion-mill.machine.toml\n"
      "  abbe reproduce wang                            a published study, recomputed\n"
      "\n"
      "An input file can be -, standard input, once per call. Existing outputs are replaced only with --force.\n"
      "Exit codes: 0 done, 1 the answer is no, 2 bad input, 3 internal error;\n"
      "interrupted: 130 by Ctrl-C, 143 by SIGTERM, 129 by SIGHUP.");
  program.set_version_flag("-V,--version", std::string("abbe ") + version_text());
  program.require_subcommand(1);
  program.set_help_all_flag("--help-all", "Help of all subcommands");
}

Subcommand* CommandLine::add(const std::string& name, const std::string& description, const std::string& example) {
  Subcommand* command = program.add_subcommand(name, description);
  command->section(section_);
  command->footer("Example:\n" + example);
  return command;
}

}  // namespace abbe
