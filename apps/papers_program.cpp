#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/files/child_process.h"
#include "abbe/formats/files/companion_program.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/report/version.h"
#include "messages.h"
#include "reproduce.h"

namespace abbe {
namespace {

constexpr CompanionProgram kPapersProgram{"abbe-papers", "ABBE_PAPERS_PROGRAM"};

/// Seconds in which the program has to say its version.
constexpr double kVersionSeconds = 10;
constexpr std::size_t kLongestVersion = 40;

/// The version that the program states; empty if it states none.
std::string stated_version(const std::filesystem::path& program) {
  const ChildProcess asked({program.string(), "--version"}, kVersionSeconds);
  const std::string_view line = asked.output().substr(0, asked.output().find('\n'));
  const std::string name = std::string(kPapersProgram.name) + " ";
  if (asked.exit_code() != 0 || !line.starts_with(name)) return {};
  return std::string(line.substr(name.size(), kLongestVersion));
}

/// Programs of two versions would take each other's options and results for their own.
void check_version(const std::filesystem::path& program) {
  const std::string version = stated_version(program);
  if (version == version_text()) return;
  throw InputError({.file = program.string()},
                   version.empty() ? fmt::format("does not state its version, and abbe is {}", version_text())
                                   : fmt::format("is version {}, and abbe is {}", version, version_text()),
                   fmt::format("{} {} (`make build` makes both)", kPapersProgram.name, version_text()));
}

/// Options that were not given have their defaults there too. Values stand behind "=", so that one that begins with a
/// dash stays a value.
std::vector<std::string> words_of(const ReproduceOptions& options) {
  std::vector<std::string> words{kPapersProgram.name, options.paper};
  if (!options.output.empty()) words.push_back("--output=" + options.output);
  if (!options.grids.empty()) words.push_back("--grids=" + options.grids);
  if (options.threads != 0) words.push_back(fmt::format("--threads={}", options.threads));
  if (options.json) words.emplace_back("--json");
  if (is_quiet()) words.emplace_back("--quiet");
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
  check_version(program);
  std::vector<std::string> words = words_of(options);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  ::execv(program.c_str(), arguments.data());
  throw InputError({.file = program.string()}, fmt::format("cannot be started: {}", std::strerror(errno)),
                   fmt::format("the program {}", kPapersProgram.name));
}

}  // namespace abbe
