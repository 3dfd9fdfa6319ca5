#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "abbe/formats/companion_program.h"
#include "abbe/formats/input_error.h"
#include "reproduce.h"

namespace abbe {
namespace {

constexpr CompanionProgram kPapersProgram{"abbe-papers", "ABBE_PAPERS_PROGRAM"};

/// Options that were not given have their defaults there too. Values stand behind "=", so that one that begins with a
/// dash stays a value.
std::vector<std::string> words_of(const ReproduceOptions& options) {
  std::vector<std::string> words{kPapersProgram.name, options.paper};
  if (!options.output.empty()) words.push_back("--output=" + options.output);
  if (!options.grids.empty()) words.push_back("--grids=" + options.grids);
  if (options.threads != 0) words.push_back(fmt::format("--threads={}", options.threads));
  if (options.json) words.emplace_back("--json");
  return words;
}

}  // namespace

int start_papers_program(const ReproduceOptions& options) {
  const std::filesystem::path program = find_companion_program(kPapersProgram);
  if (program.empty()) {
    throw InputError({.file = kPapersProgram.name}, "this program, which recomputes the published studies, is missing",
                     fmt::format("it at {} (`make build` makes it), or its name in the environment variable {}",
                                 path_beside_this_program(kPapersProgram).string(), kPapersProgram.variable));
  }
  std::vector<std::string> words = words_of(options);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  ::execv(program.c_str(), arguments.data());
  throw InputError({.file = program.string()}, fmt::format("cannot be started: {}", std::strerror(errno)),
                   fmt::format("the program {}", kPapersProgram.name));
}

}  // namespace abbe
