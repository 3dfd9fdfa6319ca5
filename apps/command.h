#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <string>

namespace abbe {

/// What the process returns.
enum ExitCode {
  kDone = 0,          ///< done
  kNegative = 1,      ///< the computation says no: not converged, rank deficient, out of range or of tolerance
  kBadInput = 2,      ///< a file or an option is wrong
  kInternalError = 3  ///< a bug
};

/// Subcommands register themselves and leave their work in `run`, which main() calls once everything is parsed.
struct CommandLine {
  CLI::App app;
  std::function<int()> run;  ///< returns an ExitCode

  CommandLine();
  /// @param example  shown at the end of --help
  CLI::App* add(const std::string& name, const std::string& description, const std::string& example);
};

void add_new_command(CommandLine& line);
void add_check_command(CommandLine& line);
void add_simulate_command(CommandLine& line);
void add_plan_command(CommandLine& line);
void add_identify_command(CommandLine& line);
void add_map_command(CommandLine& line);
void add_path_command(CommandLine& line);
void add_position_command(CommandLine& line);
void add_run_command(CommandLine& line);
void add_fit_command(CommandLine& line);
void add_evaluate_command(CommandLine& line);
void add_register_command(CommandLine& line);
void add_deviate_command(CommandLine& line);
void add_reproduce_command(CommandLine& line);
void add_test_piece_command(CommandLine& line);
void add_verify_command(CommandLine& line);

/// Progress of long work: a line on stderr that is redrawn, with the time left; nothing if stderr is no terminal or the
/// work takes less than a second.
class Progress {
 public:
  explicit Progress(std::string what);
  ~Progress();
  void operator()(std::size_t done, std::size_t total);
  std::function<void(std::size_t, std::size_t)> callback() {
    return [this](std::size_t done, std::size_t total) { (*this)(done, total); };
  }

 private:
  std::string what_;
  bool terminal_ = false;
  bool drawn_ = false;
  double start_ = 0, last_ = 0;
};

/// A file that comes with the program (published readings, machines): looked for beside the installed program and in
/// the source tree around a build folder. @throws InputError naming the places looked at
std::filesystem::path shared_file(const std::filesystem::path& relative);

}  // namespace abbe
