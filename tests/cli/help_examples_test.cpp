// Every example line of every help text is run as it stands, in a folder that looks like the repository.
#include <gmock/gmock.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "abbe/formats/files/printed_page.h"
#include "cli/all_commands.h"
#include "cli/command_test.h"

namespace abbe {
namespace {

/// Words of a line as a shell would split it; double quotes only.
std::vector<std::string> words(const std::string& line) {
  std::vector<std::string> result;
  bool quoted = false, open = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
      open = open || quoted;
      if (quoted) result.emplace_back();
    } else if (c == ' ' && !quoted) {
      open = false;
    } else {
      if (!open) result.emplace_back();
      open = true;
      result.back() += c;
    }
  }
  return result;
}

/// Lines below "Example:" that begin with the command; what follows three spaces is its description.
std::vector<std::string> example_lines(const std::string& help) {
  std::vector<std::string> lines;
  std::istringstream stream(help);
  bool below = false;
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with("Example")) below = true;
    if (!below || !line.starts_with("  abbe ")) continue;
    // A long one goes on below, as in a shell.
    for (std::string more; line.ends_with(" \\") && std::getline(stream, more);) {
      line = line.substr(0, line.size() - 1) + more.substr(more.find_first_not_of(' '));
    }
    line = line.substr(2);
    lines.push_back(line.substr(0, line.find("   ")));
  }
  return lines;
}

class HelpExamples : public CommandTest {
 protected:
  HelpExamples() {
    std::filesystem::copy(std::filesystem::path(ABBE_SOURCE_DIR) / "examples", folder.path() / "examples",
                          std::filesystem::copy_options::recursive);
  }
};

TEST_F(HelpExamples, RunFromTheRepositoryAsTheyStand) {
  std::vector<std::string> lines;
  for (const CommandWithHelp& one : all_commands([this](const auto& words) { return abbe(words); })) {
    const std::vector<std::string> here = example_lines(one.help);
    EXPECT_FALSE(here.empty()) << "no example in the help of abbe " << testing::PrintToString(one.words);
    lines.insert(lines.end(), here.begin(), here.end());
  }
  ASSERT_GT(lines.size(), 20U) << "the helps were not understood";
  std::set<std::string> once(lines.begin(), lines.end());
  // Minutes of computation; published_test runs them.
  const auto is_long = [](const std::string& line) { return line.starts_with("abbe reproduce"); };
  const auto prints = [](const std::string& line) {
    return line.ends_with(".pdf") || line.find("--pdf") != std::string::npos;
  };
  // Others begin with the results of these.
  const auto is_first = [](const std::string& line) {
    return line.starts_with("abbe run") || line.starts_with("abbe simulate");
  };
  std::vector<std::string> order(once.begin(), once.end());
  std::stable_partition(order.begin(), order.end(), is_first);
  int run = 0;
  for (const std::string& line : order) {
    if (is_long(line) || (prints(line) && find_page_printer().program.empty())) continue;
    std::vector<std::string> arguments = words(line);
    arguments.erase(arguments.begin());
    const CommandResult result = abbe(arguments);
    // A tolerance that is exceeded is an answer too.
    EXPECT_TRUE(result.exit_code == ExitCode::done || result.exit_code == ExitCode::computation_says_no)
        << line << "\n"
        << result.exit_code << " " << result.err;
    EXPECT_EQ(result.err.find("old form"), std::string::npos) << line;
    ++run;
  }
  EXPECT_GT(run, 15);
}

}  // namespace
}  // namespace abbe
