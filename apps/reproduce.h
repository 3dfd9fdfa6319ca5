#pragma once

#include <functional>
#include <string>

#include "command.h"

namespace abbe {

/// What `abbe reproduce` was asked for.
struct ReproduceOptions {
  std::string paper;   ///< "aguado", "liu", "ma", "wang" or "yin"
  std::string output;  ///< results folder; empty: print only
  std::string grids;   ///< wang: folder of indications to decouple; empty: the paper's figures
  bool json = false;
  int threads = 0;
};

/// Adds `abbe reproduce`, whose options and help two programs share: `abbe` checks them and starts abbe-papers, which
/// does the work.
/// @param run  called with options that are right; returns an ExitCode
void add_reproduce_command(CommandLine& line, const std::function<int(const ReproduceOptions&)>& run);

/// Goes on as abbe-papers (papers/), which is found beside this program or by the environment variable
/// ABBE_PAPERS_PROGRAM: the process stays, and with it its number, its streams and its exit code. Signals for which
/// this program waits (abbe/formats/files/interruption.h) stay blocked until abbe-papers waits for them.
/// @throws InputError if there is no such program or it cannot be started
int start_papers_program(const ReproduceOptions& options);

}  // namespace abbe
