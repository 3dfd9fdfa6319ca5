#pragma once

#include <functional>
#include <string>

#include "abbe/study/shared_work.h"
#include "options.h"

namespace abbe {

/// Subcommands register themselves and leave their work in `run`, which main() calls once everything is parsed.
struct CommandLine {
  Program program;
  std::function<int()> run;           ///< returns an ExitCode
  ProcessGroup* processes = nullptr;  ///< that mpirun has started; null: there is one
  bool shares_work = false;           ///< among the processes; else the first one alone runs the subcommand

  CommandLine();
  /// Heading in --help of the subcommands that are added from now on; empty: --help does not list them.
  void begin_section(const std::string& heading) { section_ = heading; }
  /// Leaves work that the processes share in `run`.
  void share(const std::function<int(ProcessGroup*)>& work) {
    shares_work = true;
    run = [work, group = processes] { return work(group); };
  }
  /// It stands in the section that was begun last.
  /// @param example  shown at the end of --help
  Subcommand* add(const std::string& name, const std::string& description, const std::string& example);

 private:
  std::string section_ = "Subcommands";
};

void add_new_command(CommandLine& line);
void add_check_command(CommandLine& line);
void add_simulate_command(CommandLine& line);
void add_plan_command(CommandLine& line);
void add_identify_command(CommandLine& line);
void add_import_command(CommandLine& line);
void add_map_command(CommandLine& line);
void add_compare_command(CommandLine& line);
void add_history_command(CommandLine& line);
void add_path_command(CommandLine& line);
void add_position_command(CommandLine& line);
void add_program_command(CommandLine& line);
void add_run_command(CommandLine& line);
void add_fit_command(CommandLine& line);
void add_evaluate_command(CommandLine& line);
void add_register_command(CommandLine& line);
void add_deviate_command(CommandLine& line);
void add_reproduce_command(CommandLine& line);
void add_test_piece_command(CommandLine& line);
void add_verify_command(CommandLine& line);
void add_completion_command(CommandLine& line);
void add_man_command(CommandLine& line);

}  // namespace abbe
