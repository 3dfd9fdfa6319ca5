// What a study can ask of its identification: orders of splines and tables, Monte Carlo with a robust loss.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "cli/command_test.h"
#include "cli/machine_for_test.h"

namespace abbe {
namespace {

using testing::HasSubstr;

/// Three intervals of X and two of Z, so rough that fewer do not do.
const char* const kTruth = R"(chain = "w X' b Z t"
[[motion]]
name = "EYX"
basis = "bspline"
order = 3
coefficients_um = [90, -80, 100, -90, 80, -100]
[[motion]]
name = "EZX"
basis = "bspline"
order = 3
coefficients_um = [-40, 60, -70, 50, -60, 40]
[[motion]]
name = "EXZ"
basis = "table-linear"
at_mm = [0, 300, 600]
coefficients_um = [0, 80, -40]
)";

const std::string kSplineStudy = std::string(R"(machine = "m.toml"
output = "out"
[simulate]
errors = "truth.errors.toml"
[[setup]]
name = "tracker"
instrument = "tracker"
noise = { xyz_um = 5 }
[[setup.station]]
name = "S"
true_pose = { position_mm = [300, -900, 150], angles_deg = [5, -3, 130] }
)") + kThreeReflectors + R"([[setup.plan]]
kind = "grid"
axis.X = { count = 15 }
axis.Z = { count = 7 }
[identify]
[[identify.motion]]
errors = "E?X"
basis = "bspline"
orders = [1, 5]
[[identify.motion]]
errors = "E?Z"
basis = "table-linear"
orders = [1, 4]
)";

class StudyIdentification : public CommandTest {
 protected:
  StudyIdentification() {
    folder.write("m.toml", kTableXColumnZ);
    folder.write("truth.errors.toml", kTruth);
  }
  void write_study(const std::vector<std::pair<std::string, std::string>>& changes = {}) const {
    std::string text = kSplineStudy;
    for (const auto& [from, to] : changes) {
      ASSERT_NE(text.find(from), std::string::npos) << from;
      text.replace(text.find(from), from.size(), to);
    }
    folder.write("s.study.toml", text);
  }
};

TEST_F(StudyIdentification, TheNumberOfIntervalsOfSplinesAndTablesIsFound) {
  write_study();
  const CommandResult result = abbe({"run", "s.study.toml"});
  ASSERT_EQ(result.exit_code, ExitCode::done) << result.err << result.out;
  EXPECT_THAT(result.out, HasSubstr("X intervals 3"));
  EXPECT_THAT(result.out, HasSubstr("Z intervals 2"));
  // The errors file has the chosen splines and tables, not the largest ones.
  const std::string errors = folder.read("out/errors.toml");
  EXPECT_THAT(errors, HasSubstr("order = 3\n"));
  EXPECT_THAT(errors, testing::Not(HasSubstr("order = 5\n")));
  EXPECT_THAT(errors, HasSubstr("at_mm = [0, 300, 600]"));
}

TEST_F(StudyIdentification, MonteCarloWithARobustLossConfirmsItsCovariance) {
  const std::pair<std::string, std::string> fixed_x = {"orders = [1, 5]", "order = 3"},
                                            fixed_z = {"orders = [1, 4]", "order = 2"};
  for (const char* loss : {"huber", "tukey"}) {
    write_study(
        {fixed_x, fixed_z, {"[identify]", "[identify]\nmonte_carlo = 1500\nloss = \"" + std::string(loss) + "\""}});
    const CommandResult result = abbe({"run", "s.study.toml", "--json"});
    ASSERT_EQ(result.exit_code, ExitCode::done) << result.err;
    const nlohmann::json figures = nlohmann::json::parse(result.out)["monte_carlo"];
    EXPECT_EQ(figures["samples"], 1500);
    EXPECT_EQ(figures["agrees"], true) << loss << figures;
    EXPECT_GT(figures["compared"], 30);
  }
}

TEST_F(StudyIdentification, AMonotoneTableIsRefused) {
  write_study({{"basis = \"table-linear\"", "basis = \"table-monotone\""}});
  const CommandResult result = abbe({"run", "s.study.toml"});
  EXPECT_EQ(result.exit_code, ExitCode::bad_input);
  EXPECT_THAT(result.err, HasSubstr("s.study.toml:32:1: identify.motion[2].basis: the functions of a monotone table"));
}

}  // namespace
}  // namespace abbe
