// abbe-papers PAPER ...: published studies, recomputed. `abbe reproduce PAPER ...` starts it with its own options
// (apps/reproduce.h), so that the studies are no part of `abbe`.
#include <fmt/format.h>

#include <string_view>
#include <vector>

#include "abbe/report/version.h"
#include "command_main.h"
#include "papers.h"

int main(int argc, char** argv) {
  // `abbe` asks before it starts the program.
  if (argc == 2 && std::string_view(argv[1]) == "--version") {
    fmt::print("abbe-papers {}\n", abbe::version_text());
    return 0;
  }
  // The same command line as there, so that help and messages are the same.
  std::vector<const char*> words{"abbe", "reproduce"};
  words.insert(words.end(), argc > 0 ? argv + 1 : argv, argv + argc);
  return abbe::command_main(static_cast<int>(words.size()), words.data(),
                            [](abbe::CommandLine& line) { abbe::add_reproduce_command(line, abbe::reproduce_paper); });
}
