#include <algorithm>

#include "abbe/formats/text/input_error.h"
#include "abbe/report/version.h"
#include "command.h"
#include "exit_code.h"
#include "man/man_page.h"
#include "messages.h"
#include "options.h"

namespace abbe {

void add_man_command(CommandLine& line) {
  struct Options {
    std::vector<std::string> words;
    bool list = false;
  };
  auto options = std::make_shared<Options>();
  Subcommand* command = line.add("man", "Print the manual page of a command for man(1)",
                                 "  abbe man compensate table | man -l -\n"
                                 "  abbe man --list");
  command->add_option("command", options->words, "The command; default: abbe itself");
  command->add_flag("--list", options->list, "Print the names of all pages");
  command->callback([&line, options] {
    line.run = [&line, options]() -> int {
      const std::vector<ManPage> pages = man_pages(line.program.describe(), version_text(), release_date_text());
      if (options->list) {
        for (const ManPage& page : pages) print_file(page.name + "\n");
        return kDone;
      }
      std::string name = "abbe", typed;
      for (const std::string& word : options->words) {
        name += "-" + word;
        typed += (typed.empty() ? "" : " ") + word;
      }
      const auto page = std::find_if(pages.begin(), pages.end(), [&](const ManPage& one) { return one.name == name; });
      if (page == pages.end()) {
        throw InputError({.field = typed}, "is no command that has a page", "one that abbe man --list names");
      }
      print_file(page->text);
      return kDone;
    };
  });
}

}  // namespace abbe
