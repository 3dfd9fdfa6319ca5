#include "command_main.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <exception>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "abbe/formats/files/existing_output.h"
#include "abbe/formats/files/interruption.h"
#include "abbe/formats/files/kept_inputs.h"
#include "abbe/formats/files/mapped_inputs.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/nearest_word.h"
#include "abbe/formats/text/not_finite.h"
#include "abbe/formats/text/utf8.h"
#include "exit_code.h"
#include "messages.h"
#include "options.h"

namespace abbe {
namespace {

constexpr std::size_t kLongestArgument = 500;

/// What was said comes before what went wrong, also where both go to one file.
void complain(const std::string& message) {
  std::fflush(stdout);
  tell("abbe: {}\n", message);
}

/// Whoever reads that something failed has to know what was written before.
void tell_complete_outputs() {
  const std::vector<std::string> names = complete_outputs();
  if (names.empty()) return;
  std::string all;
  for (const std::string& name : names) {
    all += (all.empty() ? "" : ", ") + printable(name, kLongestArgument, LineFeeds::escaped);
  }
  tell("abbe: complete before that: {}\n", all);
}

/// Results that were printed and did not arrive are not done. @returns the code of the command if they did
int printed(int code) {
  errno = 0;
  if (flush_standard_output() == 0 && std::ferror(stdout) == 0) return code;
  const int error = errno;
  complain("standard output: cannot be written" +
           (error == 0 ? std::string() : ": " + std::generic_category().message(error)) +
           "; expected a place with enough space");
  tell_complete_outputs();
  return kBadInput;
}

int run_command(int argc, const char* const* argv, const std::function<void(CommandLine&)>& add_subcommands) {
  for (int i = 1; i < argc; ++i) {
    if (!has_control_character(argv[i])) continue;
    // Names of files go into comments of programs and tables.
    complain(printable(argv[i], kLongestArgument, LineFeeds::escaped) +
             ": has control characters in it; expected a name or an option on one line");
    return kBadInput;
  }
  CommandLine line;
  add_subcommands(line);
  std::vector<const char*> words(argv, argv + argc);
  if (argc > 1 && std::string_view(argv[1]) == "help") {
    // abbe help compensate table: what abbe compensate table --help says.
    words.erase(words.begin() + 1);
    words.push_back("--help");
  }
  if (words.size() > 1 && words[1][0] != '-') {
    const std::string name = words[1];
    const std::vector<std::string> names = line.program.subcommand_names();
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      const std::optional<std::string> meant = nearest_word(name, names);
      tell("abbe: there is no subcommand '{}'.{} abbe --help lists them all.\n", name,
           meant ? " Did you mean " + *meant + "?" : "");
      return kBadInput;
    }
  }
  try {
    switch (line.program.parse(static_cast<int>(words.size()), words.data())) {
      case ParseResult::shown:
        return printed(kDone);
      case ParseResult::refused:
        return printed(kBadInput);
      case ParseResult::command:
        break;
    }
    if (line.processes != nullptr && !line.processes->is_first() && !line.shares_work) return kDone;
    return printed(line.run ? line.run() : static_cast<int>(kInternalError));
  } catch (const InputError& error) {
    complain(error.what());
    tell_complete_outputs();
    return kBadInput;
  } catch (const NotFinite& error) {
    complain(std::string("there is no result: ") + error.what() +
             "; expected inputs of a size that a machine and its errors can have");
    tell_complete_outputs();
    return kNegative;
  } catch (const SumError& error) {
    complain(error.what());
    tell_complete_outputs();
    return kBadInput;
  } catch (const std::exception& error) {
    if (std::ferror(stdout) != 0) return printed(kBadInput);
    complain(std::string("internal error: ") + error.what());
    tell_complete_outputs();
    return kInternalError;
  }
}

}  // namespace

int command_main(int argc, const char* const* argv, const std::function<void(CommandLine&)>& add_subcommands) {
  keep_numbers_of_standard_streams();
  make_standard_output_printable();
  end_cleanly_when_interrupted([](int /*signal*/) {
    if (isatty(STDERR_FILENO) == 1) draw("\r\x1b[K");
    tell("abbe: interrupted; outputs that were not finished are removed\n");
    tell_complete_outputs();
  });
  end_where_an_input_was_cut_short(kBadInput);
  // A limit on the size of files is then an error of writing, with a message and nothing half done, not the end.
  std::signal(SIGXFSZ, SIG_IGN);
  const KeptInputs kept_inputs;
  const KeptOutputs kept_outputs;
  return run_command(argc, argv, add_subcommands);
}

}  // namespace abbe
