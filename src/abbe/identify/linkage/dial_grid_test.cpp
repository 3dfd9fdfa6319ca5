#include "abbe/identify/linkage/dial_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "abbe/errors/random_stream.h"
#include "abbe/identify/linkage/dial_grid_as_printed.h"
#include "abbe/identify/linkage/wang_grids_for_test.h"

namespace abbe {
namespace {

// The reference is written with 1e-6 um and 1e-9 urad.
constexpr double kWrittenLength = 2e-9;
constexpr double kWrittenAngle = 3e-11;

double root_mean_square(const Eigen::VectorXd& v) { return std::sqrt(v.squaredNorm() / static_cast<double>(v.size())); }

void add_noise(DialGrid& grid, double standard_uncertainty, RandomStream& random) {
  for (double& value : grid.indications.reshaped()) value += standard_uncertainty * random.normal();
}

TEST(DialGrid, RowFitsGiveTheReferencesErrors) {
  const WangGrids grids = wang_grids();
  const RowFit z = fit_rows(grids.z_face, 0), y = fit_rows(grids.y_face, 0);
  EXPECT_LE((without_line(grids.z_face.positions, z.at_reference) - grids.straightness_z).cwiseAbs().maxCoeff(),
            kWrittenLength);
  EXPECT_LE((without_line(grids.y_face.positions, y.at_reference) - grids.straightness_y).cwiseAbs().maxCoeff(),
            kWrittenLength);
  EXPECT_LE((roll_of_rows(z, y) - grids.roll).cwiseAbs().maxCoeff(), kWrittenAngle);
  EXPECT_DOUBLE_EQ(z.spread, 9000);
  EXPECT_DOUBLE_EQ(y.spread, 6250);
}

TEST(DialGrid, LeastSquaresOverBothFacesIsTheSameWithoutNoise) {
  const WangGrids grids = wang_grids();
  const Decoupling result = decouple_indications(indications_of_grids(0, grids.z_face, grids.y_face, 0.0006));
  ASSERT_EQ(result.status, DecouplingStatus::ok) << result.message;
  EXPECT_LE((result.errors.col(2) - grids.straightness_z).cwiseAbs().maxCoeff(), kWrittenLength);
  EXPECT_LE((result.errors.col(1) - grids.straightness_y).cwiseAbs().maxCoeff(), kWrittenLength);
  EXPECT_LE((result.errors.col(3) - grids.roll).cwiseAbs().maxCoeff(), kWrittenAngle);
  const std::array<bool, 6> seen = {false, true, true, true, false, false};
  EXPECT_EQ(result.seen, seen);
  EXPECT_EQ(result.errors.col(4).cwiseAbs().maxCoeff(), 0) << "one dial per place cannot see pitch";
  // The dial's zero and its setting against the guideway come out beside the errors.
  EXPECT_NEAR(result.removed[2][0], 0.05, 1e-9);
  EXPECT_NEAR(result.removed[2][1], 30e-6, 1e-11);
  EXPECT_NEAR(result.removed[1][0], -0.02, 1e-9);
  EXPECT_NEAR(result.removed[1][1], -20e-6, 1e-11);
}

TEST(DialGrid, LeastSquaresHasTheRollOfTheFormulaAlsoWithNoise) {
  WangGrids grids = wang_grids();
  RandomStream random(7);
  add_noise(grids.z_face, 0.0006, random);
  add_noise(grids.y_face, 0.0006, random);
  const Decoupling result = decouple_indications(indications_of_grids(0, grids.z_face, grids.y_face, 0.0006));
  const RowFit z = fit_rows(grids.z_face, 0), y = fit_rows(grids.y_face, 0);
  EXPECT_LE((result.errors.col(3) - roll_of_rows(z, y)).cwiseAbs().maxCoeff(), 1e-16);
  // u / sqrt(w_y + w_z); straightness at y = 0: u^2 (1/n + mean^2 / (w_y + w_z)), two degrees of freedom of the line.
  EXPECT_NEAR(result.standard_uncertainty(Component::A, 4), 0.0006 / std::sqrt(9000.0 + 6250), 1e-15);
  double sum = 0;
  for (std::size_t i = 0; i < 12; ++i) sum += std::pow(result.standard_uncertainty(Component::Z, i), 2);
  EXPECT_NEAR(sum, 10 * 0.0006 * 0.0006 * (0.2 + 60.0 * 60 / 15250), 1e-15);
}

TEST(DialGrid, EveryAxisHasTheSameSigns) {
  RandomStream random(3);
  for (std::size_t direction = 0; direction < 3; ++direction) {
    AxisIndications readings =
        indications_of_grids(direction, {{0, 10, 20, 35}, {-20, 0, 50}, Eigen::MatrixXd::Zero(4, 3)},
                             {{0, 10, 20, 35}, {-30, 10, 40, 60}, Eigen::MatrixXd::Zero(4, 4)}, 0.001);
    Eigen::MatrixXd errors = Eigen::MatrixXd::Zero(4, 6);
    const Eigen::Index roll = 3 + static_cast<Eigen::Index>(direction);
    for (Eigen::Index i = 0; i < 4; ++i) errors(i, roll) = 1e-5 * random.normal();
    readings.indications = exact_indications(readings, errors);
    const RowFit second = fit_rows({readings.positions, {-20, 0, 50}, readings.indications.leftCols(3)}, 0);
    const RowFit first = fit_rows({readings.positions, {-30, 10, 40, 60}, readings.indications.rightCols(4)}, 0);
    EXPECT_LE((roll_of_rows(second, first) - errors.col(roll)).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LE((decouple_indications(readings).errors.col(roll) - errors.col(roll)).cwiseAbs().maxCoeff(), 1e-9);
  }
}

// Figures of an independent program for the same files: root mean square of (5) and (8) less the truth.
TEST(DialGridAsPrinted, KeepsDialZeroAndSettingAndLosesTheRoll) {
  const WangGrids grids = wang_grids();
  const DialGridAsPrinted printed = decouple_grids_as_printed(grids.z_face, grids.y_face);
  EXPECT_NEAR(root_mean_square(printed.straightness_z - grids.straightness_z), 56.75138765e-3, 1e-9);
  EXPECT_NEAR(root_mean_square(printed.straightness_y - grids.straightness_y), 20.81076233e-3, 1e-9);
  EXPECT_LE((printed.roll_from_z - grids.roll).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_LE((printed.roll_from_y + grids.roll).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_LE(printed.roll.cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_NEAR(printed.pitch, 27.785690437e-6, 1e-12);
  EXPECT_NEAR(printed.yaw, -18.154741538e-6, 1e-12);
}

TEST(DialGrid, RefusesSizesThatDoNotFit) {
  DialGrid grid{{0, 1, 2}, {0, 0}, Eigen::MatrixXd::Zero(3, 2)};
  EXPECT_THROW(fit_rows(grid, 0), std::invalid_argument);
  grid.across = {0, 1, 2};
  EXPECT_THROW(fit_rows(grid, 0), std::invalid_argument);
  EXPECT_THROW(without_line({0, 1}, Eigen::VectorXd::Zero(2)), std::invalid_argument);
  EXPECT_THROW(without_line({1, 1, 1}, Eigen::VectorXd::Zero(3)), std::invalid_argument);
}

}  // namespace
}  // namespace abbe
