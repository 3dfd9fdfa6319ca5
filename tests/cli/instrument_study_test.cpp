#include "cli/instrument_study_test.h"

#include <gmock/gmock.h>

namespace abbe {
namespace {

using testing::HasSubstr;

TEST_F(InstrumentStudies, ABallBarOnATrunnionMill) {
  const nlohmann::json summary = expect_same_from_files("trunnion", "ball-bar");
  const nlohmann::json& held_out = summary["held_out"];
  EXPECT_LT(held_out["position_after_um"]["mean"].get<double>(),
            0.3 * held_out["position_before_um"]["mean"].get<double>());
  EXPECT_GT(held_out["coverage_percent"].get<double>(), 90);
}

TEST_F(InstrumentStudies, ATrackingInterferometerOnAThreeAxisMill) {
  const nlohmann::json summary = expect_same_from_files("three_axis", "tracking-interferometer");
  const nlohmann::json& held_out = summary["held_out"];
  EXPECT_LT(held_out["position_after_um"]["mean"].get<double>(),
            0.1 * held_out["position_before_um"]["mean"].get<double>());
  EXPECT_GT(held_out["coverage_percent"].get<double>(), 90);
}

TEST_F(InstrumentStudies, ACircleOutOfReachIsSaid) {
  folder.write("bar.study.toml", "machine = \"" + std::string(ABBE_SOURCE_DIR) +
                                     "/examples/machines/trunnion-mill.machine.toml\"\n"
                                     "[simulate.generator]\nmean_volumetric_um = 10\n"
                                     "[[setup]]\nname = \"bar\"\ninstrument = \"ball-bar\"\n"
                                     "spindle_ball_mm = [0, 0, -150]\nnoise = { length_um = 1 }\n"
                                     "[[setup.ball]]\nname = \"B\"\ncentre_mm = [0, 0, 60]\n"
                                     "[[setup.plan]]\nkind = \"circle\"\nplane = [\"X\", \"Y\"]\nradius_mm = 1000\n"
                                     "points = 8\n[identify]\n[[identify.motion]]\nerrors = \"EXX\"\n"
                                     "basis = \"legendre\"\norder = 1\n");
  const CommandResult result = abbe({"run", "bar.study.toml", "-o", "out"});
  EXPECT_EQ(result.exit_code, bad_input);
  EXPECT_THAT(result.err, HasSubstr("the circle is out of reach of the linear axes at"));
}

}  // namespace
}  // namespace abbe
