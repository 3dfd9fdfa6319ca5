#include "abbe/instruments/board_marks.h"

#include <Eigen/Geometry>

#include "abbe/geometry/angle_units.h"
#include "abbe/instruments/instrument_for_test.h"
#include "abbe/instruments/meeting_for_test.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

/// Two boards, one lying and one leaning, at the middle of the machine's travel.
BoardMarksSetup two_boards(const Machine& machine, BoardMarksSetup::Position position, bool width) {
  BoardMarksSetup setup;
  setup.name = "marks";
  setup.position = position;
  setup.width = width;
  setup.focus = SetupPoint::within({0.02, -0.2, -150}, 0.05);
  setup.beam = {0.01, 0, 1};
  setup.beam_tilt_first = SetupNumber::within(2e-3, 1e-3);
  setup.beam_tilt_second = SetupNumber::open(-1e-3);
  const Eigen::Vector3d at = test::seen_from_workpiece(machine, ErrorSet{}, test::middle(machine), setup.focus.value());
  setup.boards = {{"lying", SetupPoint::open(at), SetupPoint::open({0.01, -0.02, 0.3})},
                  {"leaning", SetupPoint::open(at + Eigen::Vector3d(5, 0, 2)), SetupPoint::open({0.3, 0.1, -0.5})}};
  setup.waist = SetupNumber::open(0.03);
  setup.divergence = SetupNumber::open(0.05);
  return setup;
}

TEST(BoardMarks, LieOnTheBeamAndOnTheBoard) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::some_errors(machine);
  const BoardMarksSetup setup = two_boards(machine, BoardMarksSetup::Position::point, true);
  const auto marks = std::make_shared<BoardMarks>(setup);
  const InstrumentReadings plan = test::meeting_plan(machine, *marks, 2, 0.4, 12);
  const InstrumentReadings readings = test::exact_readings(machine, errors, marks, plan);
  const DirectionFrame frame = DirectionFrame::of(setup.beam);
  const Eigen::Vector3d source =
      frame.direction + setup.beam_tilt_first.value * frame.first + setup.beam_tilt_second.value * frame.second;
  double farthest = 0;
  for (std::size_t k = 0; k < readings.count(); ++k) {
    const BoardMarksSetup::Board& board = setup.boards[plan.item[k]];
    const Eigen::Vector3d a = board.angles.value();
    const Eigen::Vector3d mark =
        board.position.value() + Eigen::AngleAxisd(a[2], Eigen::Vector3d::UnitZ()) *
                                     (Eigen::AngleAxisd(a[1], Eigen::Vector3d::UnitY()) *
                                      (Eigen::AngleAxisd(a[0], Eigen::Vector3d::UnitX()) *
                                       Eigen::Vector3d(readings.measured[0][k], readings.measured[1][k], 0)));
    const RigidTransform tool = actual_workpiece_from_tool(machine, errors, plan.poses.pose(k));
    const Eigen::Vector3d focus = tool * Eigen::Vector3d(setup.focus.value() - machine.tool_offset);
    EXPECT_NEAR((mark - focus).cross(tool.rotation * source.normalized()).norm(), 0, 1e-9);
    const double distance = (mark - focus).norm();
    EXPECT_NEAR(readings.measured[2][k], std::hypot(0.03, 0.05 * distance), 1e-9);
    farthest = std::max(farthest, distance);
  }
  EXPECT_GT(farthest, 0.5);
}

TEST(BoardMarks, LinesAreReadAcrossThemselves) {
  const Machine machine = test::trunnion_mill();
  const ErrorSet errors = test::some_errors(machine);
  const auto points = std::make_shared<BoardMarks>(two_boards(machine, BoardMarksSetup::Position::point, false));
  const auto lines = std::make_shared<BoardMarks>(two_boards(machine, BoardMarksSetup::Position::line, true));
  const InstrumentReadings plan = test::meeting_plan(machine, *points, 1, 0.4, 5);
  InstrumentReadings line_plan = plan;
  line_plan.inputs = {std::vector<double>(plan.count(), 60 * kDegree)};
  const InstrumentReadings of_points = test::exact_readings(machine, errors, points, plan);
  const InstrumentReadings of_lines = test::exact_readings(machine, errors, lines, line_plan);
  for (std::size_t k = 0; k < plan.count(); ++k) {
    EXPECT_NEAR(of_lines.measured[0][k], of_points.measured[0][k] / 2 + of_points.measured[1][k] * std::sqrt(3.0) / 2,
                1e-12);
  }
}

TEST(BoardMarks, DerivativesEqualDifferences) {
  using Position = BoardMarksSetup::Position;
  for (const Machine& machine : {test::trunnion_mill(), test::head_table_mill(), test::yin_engraver('U')}) {
    for (const Position position : {Position::none, Position::point, Position::line}) {
      BoardMarksSetup setup = two_boards(machine, position, position != Position::line);
      setup.waist = SetupNumber::open(3);  // a wide focus: levers of metres times 1e-5 rad stay small against it
      const auto marks = std::make_shared<BoardMarks>(setup);
      std::vector<double> inputs;
      if (position == Position::line) inputs = {0.7};
      test::expect_jacobian_equals_differences(machine, test::some_errors(machine), marks,
                                               test::meeting_plan(machine, *marks, 2, 0.3, 10, inputs), 5e-6);
    }
  }
}

/// The five steps on the engraver as its text has it, against the corrected equations (9) to (12).
struct Engraver {
  Machine machine = test::yin_engraver('U');
  std::shared_ptr<BoardMarks> marks;

  Engraver(const Eigen::Vector3d& at, const Eigen::Vector3d& angles) {
    BoardMarksSetup setup;
    setup.width = true;
    setup.focus = SetupPoint::exact(machine.tool_offset);
    setup.boards = {{"board", SetupPoint::exact(at), SetupPoint::exact(angles)}};
    setup.divergence = SetupNumber::exact(0.05);
    marks = std::make_shared<BoardMarks>(setup);
  }
  std::vector<double> pose(double x, double y, double z, double c1, double a, double c2) const {
    std::vector<double> positions(machine.axes.size(), 0.0);
    const auto put = [&](const char* axis, double value) { positions[machine.find_axis(axis)] = value; };
    put("X", x);
    put("Y", y);
    put("Z", z);
    put("C1", c1 * kDegree);
    put("A", a * kDegree);
    put("C2", c2 * kDegree);
    return positions;
  }
  /// u, v, width of one mark.
  std::array<double, 3> read(const std::vector<double>& positions) const {
    InstrumentReadings plan;
    plan.append(positions, 0);
    const InstrumentReadings readings = test::exact_readings(machine, ErrorSet{}, marks, plan);
    return {readings.measured[0][0], readings.measured[1][0], readings.measured[2][0]};
  }
};

TEST(BoardMarks, StepFourOfYinGivesTheRadiusOfTheSwingHead) {
  // Board of 4 mm lying on the table; lines at C1 = 0 and 180 degrees with X moved by -418 mm.
  const Engraver engraver({0, 0, 4}, {0, 0, 0});
  const double z = -528.996 + 240.745 + 4;
  const auto l3 = engraver.read(engraver.pose(0, 0, z, 0, 0, 0));
  const auto l5 = engraver.read(engraver.pose(-418, 0, z, 180, 0, 0));
  EXPECT_NEAR(l3[0], 12.240, 1e-9);
  EXPECT_NEAR(l5[0], 11.288, 1e-9);
  EXPECT_NEAR(l3[1], 24.896, 1e-9);
  EXPECT_NEAR(l5[1], 25.716, 1e-9);
  // 2 R_C1 = s (x2 - x1) + (p_l3 - p_l5) with s = dp/dX = -1 here; L_AC1 = (p_l4 - p_l6) / 2 - L_tA.
  EXPECT_NEAR((418 + l3[0] - l5[0]) / 2, 209.476, 1e-9);
  EXPECT_NEAR((l3[1] - l5[1]) / 2 + 0.265, -0.145, 1e-9);
  EXPECT_NEAR(l3[2], 0.03, 1e-9) << "in focus";
}

TEST(BoardMarks, StepThreeOfYinGivesTwiceTheOffsetOfTheBeam) {
  // Board upright across X: u = Y, v = Z, engraved from +X at C1 = A = 90 degrees and turned with C2.
  const Engraver engraver({0, 0, 0}, {90 * kDegree, 0, 90 * kDegree});
  const double z = -288.251;
  const auto l1 = engraver.read(engraver.pose(-432.586, -234.782, z, 90, 90, 0));
  const auto l2 = engraver.read(engraver.pose(38.114, -234.782, z, 90, -90, 180));
  EXPECT_NEAR(std::abs(l1[1] - l2[1]), 2 * 0.265, 1e-6);
}

TEST(BoardMarks, StepTwoOfYinFindsTheFocusByTheParabola) {
  const Engraver engraver({0, 0, 4}, {0, 0, 0});
  // Three widths at steps of 1 mm give the parabola of the square.
  const double z0 = -285;
  double square[3];
  for (int i = 0; i < 3; ++i) square[i] = std::pow(engraver.read(engraver.pose(0, 0, z0 + i, 0, 0, 0))[2], 2);
  const double bend = (square[0] - 2 * square[1] + square[2]) / 2, slope = (square[2] - square[0]) / 2;
  const double lowest = z0 + 1 - slope / (2 * bend);
  EXPECT_NEAR(lowest - 4 + 528.996, 240.745, 1e-9) << "R_A";
  EXPECT_NEAR(std::sqrt(bend), 0.05, 1e-9);
}

TEST(BoardMarks, StepFiveOfYinEngravesAPointOnTheAxisOfTheTable) {
  const Engraver engraver({0, 0, 4}, {0, 0, 0});
  const double z = -284.251;
  const auto at = engraver.read(engraver.pose(-196.826, 234.782, z, 90, 0, 0));
  const auto turned = engraver.read(engraver.pose(-196.826, 234.782, z, 90, 0, 70));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(at[i], turned[i], 1e-9);
  EXPECT_NEAR(at[0], 0, 1e-9);
  EXPECT_NEAR(at[1], 0, 1e-9);
}

TEST(BoardMarks, RefuseASetupThatIsNone) {
  BoardMarksSetup bad;
  EXPECT_THROW(BoardMarks{bad}, std::invalid_argument);
  bad.boards.resize(1);
  bad.position = BoardMarksSetup::Position::none;
  EXPECT_THROW(BoardMarks{bad}, std::invalid_argument);
  bad.width = true;
  bad.waist = SetupNumber::exact(0);
  EXPECT_THROW(BoardMarks{bad}, std::invalid_argument);
}

}  // namespace
}  // namespace abbe
