#include "command.h"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>

#include "abbe/formats/input_error.h"

namespace abbe {
namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

CommandLine::CommandLine()
    : app("Geometric accuracy of multi-axis machines: model, identify, verify, report.", "abbe") {
  app.footer(
      "Examples:\n"
      "  abbe run examples/aguado/aguado.study.toml     the whole job, from readings to the report\n"
      "  abbe check examples/machines/trunnion-mill.machine.toml\n"
      "  abbe reproduce wang                            a published study, recomputed\n\n"
      "Exit codes: 0 done, 1 the computation says no, 2 bad input, 3 internal error;\n"
      "interrupted: 130 by Ctrl-C, 143 by SIGTERM, 129 by SIGHUP.");
  app.set_version_flag("--version", "abbe " ABBE_VERSION);
  app.require_subcommand(1);
  app.set_help_all_flag("--help-all", "Help of all subcommands");
}

CLI::App* CommandLine::add(const std::string& name, const std::string& description, const std::string& example) {
  CLI::App* command = app.add_subcommand(name, description);
  command->footer("Example:\n" + example);
  return command;
}

Progress::Progress(std::string what) : what_(std::move(what)), terminal_(isatty(STDERR_FILENO) == 1), start_(now()) {}

Progress::~Progress() {
  if (drawn_) fmt::print(stderr, "\r\x1b[K");
}

void Progress::operator()(std::size_t done, std::size_t total) {
  if (!terminal_ || total == 0) return;
  const double time = now();
  if (time - start_ < 1 || time - last_ < 0.1) return;
  last_ = time;
  drawn_ = true;
  const double share = static_cast<double>(done) / static_cast<double>(total);
  const double left = share > 0 ? (time - start_) * (1 - share) / share : 0;
  fmt::print(stderr, "\r\x1b[K{}  {:3.0f} %  {:.0f} s left", what_, 100 * share, left);
  std::fflush(stderr);
}

std::filesystem::path shared_file(const std::filesystem::path& relative) {
  std::error_code ignored;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path();
  const std::filesystem::path places[] = {
      program / ".." / "share" / "abbe" / relative,  // installed
      program / ".." / ".." / ".." / relative,       // build/<preset>/bin in the source tree
      program / ".." / ".." / ".." / "tests" / relative,
  };
  for (const std::filesystem::path& place : places) {
    if (std::filesystem::exists(place, ignored)) return std::filesystem::weakly_canonical(place, ignored);
  }
  throw InputError({.file = relative.string()}, "this file of the program was not found",
                   fmt::format("it at {} or {}", places[0].string(), places[1].string()));
}

}  // namespace abbe
