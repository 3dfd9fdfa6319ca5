#include <gmock/gmock.h>

#include <fstream>

#include "cli/command_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

class TestPieceCommand : public CommandTest {
 protected:
  const std::string machine =
      (std::filesystem::path(ABBE_SOURCE_DIR) / "examples/machines/trunnion-mill.machine.toml").string();
  const std::string cone = (folder.path() / "cone.csv").string();
};

TEST_F(TestPieceCommand, BothPiecesBecomeProgramsForATrunnionMill) {
  for (const std::string piece : {"cone-frustum", "s-shape"}) {
    const std::string csv = (folder.path() / (piece + ".csv")).string();
    const std::string program = (folder.path() / (piece + ".ngc")).string();
    EXPECT_EQ(abbe({"test-piece", piece, "-o", csv}).exit_code, 0);
    const CommandResult path = abbe({"path", csv, "--machine", machine, "-o", program});
    EXPECT_EQ(path.exit_code, 0) << path.err;
    std::ifstream file(program);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    EXPECT_THAT(text, HasSubstr("G93"));
    EXPECT_THAT(text, HasSubstr(" A"));
    EXPECT_THAT(text, HasSubstr(" C"));
  }
}

TEST_F(TestPieceCommand, AnExistingFileStaysAndWrongSizesAreSaid) {
  EXPECT_EQ(abbe({"test-piece", "cone-frustum", "-o", cone}).exit_code, 0);
  const CommandResult again = abbe({"test-piece", "cone-frustum", "-o", cone});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.err, HasSubstr("the file exists"));
  EXPECT_EQ(abbe({"test-piece", "cone-frustum", "-o", cone, "--force"}).exit_code, 0);
  const CommandResult wrong = abbe({"test-piece", "s-shape", "--tool-diameter-mm", "60"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("expected a tool of a smaller radius than its crests have"));
  const auto refused = [&](const std::string& piece, const std::string& option, const char* value) {
    const CommandResult result = abbe({"test-piece", piece, option, value});
    EXPECT_EQ(result.exit_code, 2) << option;
    EXPECT_THAT(result.err, HasSubstr(option));
  };
  for (const char* const option : {"--base-diameter-mm", "--tool-diameter-mm", "--height-mm", "--azimuth-deg",
                                   "--half-apex-deg", "--inclination-deg", "--feed-mm-per-min", "--chord-um"}) {
    refused("cone-frustum", option, "1e300");
  }
  for (const char* const option : {"--length-mm", "--amplitude-mm", "--lean-deg", "--twist-deg"}) {
    refused("s-shape", option, "1e300");
  }
}

TEST_F(TestPieceCommand, TheCurveIsPrintedWithoutAFile) {
  const CommandResult printed = abbe({"test-piece", "cone-frustum", "--centre-mm", "10", "20", "30"});
  EXPECT_EQ(printed.exit_code, 0);
  EXPECT_THAT(printed.out, HasSubstr("x_mm,y_mm,z_mm,i,j,k,feed_mm_per_min,beam\n"));
}

}  // namespace
}  // namespace abbe
