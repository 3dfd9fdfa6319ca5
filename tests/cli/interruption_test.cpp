// Ctrl-C: exit code 130, nothing half done is left, older results stay.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <map>
#include <sstream>
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
  std::string example(const std::string& name) const { return std::string(ABBE_SOURCE_DIR "/examples/") + name; }

  std::vector<std::string> plan(const std::string& distance_mm) const {
    return {"scan",
            "plan",
            example("cradle_scanner/pyramid.stl"),
            "--machine",
            example("machines/liu-scanner.machine.toml"),
            "--along-mm",
            distance_mm,
            "--between-mm",
            distance_mm,
            "--force",
            "-o",
            "path.csv"};
  }

  std::vector<std::string> names() const {
    std::vector<std::string> result;
    for (const auto& entry : fs::directory_iterator(folder.path())) result.push_back(entry.path().filename().string());
    return result;
  }

  /// The folder in which results are being written, or nothing.
  fs::path unfinished() const {
    for (const std::string& name : names()) {
      if (name.find(".abbe-unfinished") != std::string::npos) return folder.path() / name;
    }
    return "/nowhere";
  }

  /// Bytes of all files in a folder.
  std::map<std::string, std::string> contents(const std::string& name) const {
    std::map<std::string, std::string> result;
    for (const auto& entry : fs::directory_iterator(folder.path() / name)) {
      const std::string file = entry.path().filename().string();
      result[file] = folder.read(name + "/" + file);
    }
    return result;
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

/// Whether the program has a file of the folder open, be it one without a name.
bool holds_a_file_in(const fs::path& folder, pid_t process) {
  std::error_code error;
  const std::string within = fs::canonical(folder).string() + "/";
  for (const auto& entry : fs::directory_iterator("/proc/" + std::to_string(process) + "/fd", error)) {
    if (fs::read_symlink(entry.path(), error).string().rfind(within, 0) == 0) return true;
  }
  return false;
}

/// Time of the processor that all threads of a process have used, s.
double used_time(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string text;
  std::getline(file, text);
  // The name of the program, in parentheses, may hold blanks; utime and stime are the 12th and 13th field behind it.
  const std::size_t name_end = text.rfind(')');
  if (name_end == std::string::npos) return 0;
  std::istringstream fields(text.substr(name_end + 1));
  std::string skipped;
  for (int i = 0; i < 11; ++i) fields >> skipped;
  double user = 0, system = 0;
  fields >> user >> system;
  return (user + system) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

/// A pipe with a name stands where a program is going to write a file: it gets no further than what a pipe holds, 64
/// KiB, because nobody reads more than the first byte.
class HeldUpWriter {
 public:
  HeldUpWriter() = default;
  ~HeldUpWriter() {
    if (pipe_ >= 0) ::close(pipe_);
  }
  HeldUpWriter(const HeldUpWriter&) = delete;
  HeldUpWriter& operator=(const HeldUpWriter&) = delete;

  /// Whether something has been written into the pipe. The program waits until this is asked.
  bool writes_to(const fs::path& pipe) {
    struct stat status = {};
    if (::stat(pipe.c_str(), &status) != 0 || !S_ISFIFO(status.st_mode)) return false;
    if (pipe_ < 0) pipe_ = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    char first = 0;
    return pipe_ >= 0 && ::read(pipe_, &first, 1) == 1;
  }

 private:
  int pipe_ = -1;
};

TEST_F(Interruption, WhileItComputesACommandEndsWithTheNumberOfTheSignalAndWritesNothing) {
  // Planning takes a minute. Half a second is more than any start and reading of 24 triangles needs.
  const auto computes = [](pid_t process) { return used_time(process) > 0.5; };
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const CommandResult result = interrupted(plan("0.02"), signal, computes);
    ASSERT_TRUE(result.signalled) << "it ended before: exit code " << result.exit_code << ", " << result.err;
    EXPECT_EQ(result.exit_code, 128 + signal);
    EXPECT_THAT(result.err, HasSubstr("abbe: interrupted"));
    EXPECT_EQ(result.out, "");
    EXPECT_THAT(names(), testing::IsEmpty());
  }
}

TEST_F(Interruption, AProgramThatTookThePlaceOfTheCommandEndsLikeIt) {
  const auto computes = [](pid_t process) {
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/" + std::to_string(process) + "/exe", error);
    return program.filename() == "abbe-papers" && used_time(process) > 0.5;
  };
  const CommandResult result = interrupted({"reproduce", "aguado", "-o", "results"}, SIGINT, computes);
  ASSERT_TRUE(result.signalled) << "it ended before: exit code " << result.exit_code << ", " << result.err;
  EXPECT_EQ(result.exit_code, 130);
  EXPECT_EQ(result.err, "abbe: interrupted; outputs that were not finished are removed\n");
  EXPECT_EQ(result.out, "");
  EXPECT_THAT(names(), testing::IsEmpty());
}

TEST_F(Interruption, WhileResultsAreWrittenTheOlderOnesStayWhole) {
  const std::vector<std::string> deviate{"deviate",     example("scan/pin-scan.csv"),      example("scan/pin.stl"),
                                         "--transform", example("scan/pin-transform.csv"), "-o",
                                         "out"};
  std::vector<std::string> other = deviate;
  other.insert(other.end(), {"--largest-mm", "0.001"});
  bool was_interrupted = false;
  for (int attempt = 0; attempt < 50 && !was_interrupted; ++attempt) {
    ASSERT_EQ(abbe(deviate).exit_code, ExitCode::done);
    const std::map<std::string, std::string> older = contents("out");
    HeldUpWriter writer;
    bool stands = false;
    const CommandResult result = interrupted(other, SIGINT, [&](pid_t) {
      // Behind the first files and before the page: who comes too late here tries again.
      const fs::path page = unfinished() / "report.html";
      stands = stands || ::mkfifo(page.c_str(), 0600) == 0;
      return stands && writer.writes_to(page);
    });
    EXPECT_THAT(names(), testing::ElementsAre("out"));
    was_interrupted = result.signalled;
    if (!was_interrupted) {
      ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
      EXPECT_NE(contents("out"), older);
      continue;
    }
    EXPECT_EQ(result.exit_code, 130) << result.err;
    EXPECT_TRUE(contents("out") == older) << "not the older result";
  }
  EXPECT_TRUE(was_interrupted) << "no run was interrupted while it wrote";
}

TEST_F(Interruption, WhileAFileIsWrittenNothingOfItIsLeftAndTheOlderOneStays) {
  ASSERT_EQ(abbe(plan("0.5")).exit_code, ExitCode::done);
  const std::string whole = folder.read("path.csv");
  fs::remove(folder.path() / "path.csv");
  for (const bool has_older : {false, true}) {
    bool was_interrupted = false;
    for (int attempt = 0; attempt < 50 && !was_interrupted; ++attempt) {
      if (has_older) folder.write("path.csv", "older\n");
      const CommandResult result =
          interrupted(plan("0.5"), SIGINT, [&](pid_t process) { return holds_a_file_in(folder.path(), process); });
      // Who comes too late here tries again: the file was complete, with the end of the command still to come or not.
      const bool is_complete = result.err.find("abbe: complete before that: path.csv\n") != std::string::npos;
      was_interrupted = result.exit_code == 130 && !is_complete;
      if (!was_interrupted) {
        EXPECT_THAT(names(), testing::ElementsAre("path.csv"));
        EXPECT_TRUE(folder.read("path.csv") == whole) << "exit code " << result.exit_code << ", " << result.err;
      } else if (has_older) {
        EXPECT_THAT(names(), testing::ElementsAre("path.csv"));
        EXPECT_EQ(folder.read("path.csv"), "older\n");
      } else {
        EXPECT_THAT(names(), testing::IsEmpty());
      }
      fs::remove(folder.path() / "path.csv");
    }
    EXPECT_TRUE(was_interrupted) << "no run was interrupted while it wrote";
  }
}

TEST_F(Interruption, SaysWhatWasCompleteBefore) {
  // A full pipe as standard output holds the command up after its file is complete.
  const CommandResult result =
      run_and_signal("/bin/sh",
                     {"-c", "mkfifo full; exec 3<>full; head -c 65536 /dev/zero >&3; exec " ABBE_COMMAND
                            " test-piece cone-frustum -o cone.csv >&3"},
                     folder.path(), SIGINT, [&](pid_t) { return fs::exists(folder.path() / "cone.csv"); });
  EXPECT_EQ(result.exit_code, 130);
  EXPECT_EQ(result.err,
            "abbe: interrupted; outputs that were not finished are removed\n"
            "abbe: complete before that: cone.csv\n");
}

TEST_F(Interruption, ASignalThatWasIgnoredBeforeStaysIgnored) {
  // As under nohup, which ignores SIGHUP and starts the command. Half a second of planning is still to come.
  std::string command = "trap '' INT; exec " ABBE_COMMAND;
  for (const std::string& word : plan("0.2")) command += " '" + word + "'";
  const CommandResult result = run_and_signal("/bin/sh", {"-c", command}, folder.path(), SIGINT, waits_for_signals);
  ASSERT_TRUE(result.signalled) << "it ended before: exit code " << result.exit_code << ", " << result.err;
  EXPECT_EQ(result.exit_code, ExitCode::done) << result.err;
  EXPECT_THAT(names(), testing::ElementsAre("path.csv"));
}

}  // namespace
}  // namespace abbe
