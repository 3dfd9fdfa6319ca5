// Ctrl-C: exit code 130, nothing half done is left, older results stay.
#include <gmock/gmock.h>

#include <csignal>
#include <fstream>
#include <string>

#include "cli/command_test.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Interruption : public CommandTest {
 protected:
  CommandResult interrupted(const std::vector<std::string>& arguments, int signal,
                            const std::function<bool(pid_t)>& is_time) const {
    return run_and_signal(ABBE_COMMAND, arguments, folder.path(), signal, is_time);
  }
  std::string example(const std::string& name) const { return std::string(ABBE_SOURCE_DIR) + "/examples/" + name; }

  std::vector<std::string> names() const {
    std::vector<std::string> result;
    for (const auto& entry : fs::directory_iterator(folder.path())) result.push_back(entry.path().filename().string());
    return result;
  }
  bool has_partial() const {
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder.path(), ignored)) {
      if (entry.path().filename().string().find(".partial-") != std::string::npos) return true;
    }
    return false;
  }
};

/// The program has started to wait for signals: SIGTERM is blocked in its first thread.
bool waits_for_signals(pid_t process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  std::string line;
  while (std::getline(status, line)) {
    if (line.rfind("SigBlk:", 0) == 0) return (std::stoull(line.substr(7), nullptr, 16) >> (SIGTERM - 1) & 1U) != 0;
  }
  return false;
}

TEST_F(Interruption, WhileItComputesACommandEndsWith130AndWritesNothing) {
  const std::vector<std::string> plan{"scan",
                                      "plan",
                                      example("cradle_scanner/pyramid.stl"),
                                      "--machine",
                                      example("machines/liu-scanner.machine.toml"),
                                      "--along-mm",
                                      "0.01",
                                      "--between-mm",
                                      "0.01",
                                      "-o",
                                      "path.csv",
                                      "--coverage",
                                      "coverage.ply"};
  const CommandResult result = interrupted(plan, SIGINT, waits_for_signals);
  EXPECT_EQ(result.exit_code, 130);
  EXPECT_THAT(result.err, HasSubstr("abbe: interrupted"));
  EXPECT_EQ(result.out, "");
  EXPECT_THAT(names(), testing::IsEmpty());
  EXPECT_EQ(interrupted(plan, SIGTERM, waits_for_signals).exit_code, 143);
  EXPECT_THAT(names(), testing::IsEmpty());
}

TEST_F(Interruption, WhileResultsAreWrittenTheOlderOnesStayWhole) {
  const std::vector<std::string> deviate{"deviate",     example("scan/pin-scan.csv"),      example("scan/pin.stl"),
                                         "--transform", example("scan/pin-transform.csv"), "-o",
                                         "out"};
  ASSERT_EQ(abbe(deviate).exit_code, ExitCode::done);
  const std::string older = folder.read("out/evaluation.json");
  std::vector<std::string> other = deviate;
  other.insert(other.end(), {"--largest-mm", "0.001"});
  int ended = 0;
  for (int attempt = 0; attempt < 20 && ended < 3; ++attempt) {
    const CommandResult result = interrupted(other, SIGINT, [&](pid_t) { return has_partial(); });
    EXPECT_THAT(names(), testing::ElementsAre("out"));
    EXPECT_TRUE(fs::exists(folder.path() / "out" / "report.html"));
    if (result.exit_code == 130) {
      ++ended;
      // Interrupted before the exchange, or during it: the older result, or the whole new one.
      EXPECT_TRUE(fs::exists(folder.path() / "out" / ".abbe-results"));
    } else {
      EXPECT_EQ(result.exit_code, ExitCode::done) << result.err;
    }
    ASSERT_EQ(abbe(deviate).exit_code, ExitCode::done);
    EXPECT_EQ(folder.read("out/evaluation.json"), older);
  }
  EXPECT_GT(ended, 0) << "no run was interrupted while it wrote";
}

TEST_F(Interruption, WhileAFileIsWrittenNothingOfItIsLeft) {
  const std::vector<std::string> path{
      "path",        example("machines/yin-engraver-u.machine.toml"), example("laser_engraver/table-a4.csv"),
      "--placement", example("laser_engraver/part.placement.toml"),   "-o",
      "program.ngc"};
  for (int attempt = 0; attempt < 5; ++attempt) {
    const CommandResult result = interrupted(path, SIGINT, [&](pid_t) { return has_partial(); });
    EXPECT_THAT(result.exit_code, testing::AnyOf(130, 0)) << result.err;
    EXPECT_FALSE(has_partial());
    for (const std::string& name : names()) EXPECT_THAT(folder.read(name), testing::EndsWith("M30\n"));
  }
}

TEST_F(Interruption, ASignalThatWasIgnoredBeforeStaysIgnored) {
  // As under nohup, which ignores SIGHUP and starts the command.
  const CommandResult result = run_and_signal(
      "/bin/sh", {"-c", "trap '' INT; exec " ABBE_COMMAND " check " + example("machines/liu-scanner.machine.toml")},
      folder.path(), SIGINT, waits_for_signals);
  EXPECT_EQ(result.exit_code, ExitCode::done) << result.err;
}

}  // namespace
}  // namespace abbe
