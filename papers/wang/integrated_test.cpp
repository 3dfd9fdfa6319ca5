#include "wang/integrated.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "wang/figures.h"
#include "wang/tables.h"

namespace abbe {
namespace {

/// Columns of a line of forward_chain.csv.
std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
  return fields;
}

/// The position of a pose of the map, as a row of its table; 12 if it is none.
std::size_t row_of(std::size_t table, double position) {
  for (std::size_t row = 0; row < 12; ++row) {
    const double there = wang_row(table, row).position * (table > 2 ? std::acos(-1.0) / 180 : 1);
    if (std::abs(position - there) < 1e-12) return row;
  }
  return 12;
}

TEST(WangIntegrated, MapIsEquation18AsAnIndependentProgramComputesIt) {
  std::ifstream file(std::string(ABBE_SOURCE_DIR "/tests/golden/wang/forward_chain.csv"));
  std::string line;
  std::getline(file, line);  // comment
  std::getline(file, line);
  const std::vector<std::string> header = fields_of(line);
  const auto column = [&](const char* name) {
    return static_cast<std::size_t>(std::find(header.begin(), header.end(), name) - header.begin());
  };
  std::size_t compared = 0;
  while (std::getline(file, line)) {
    const std::vector<std::string> row = fields_of(line);
    if (row[column("convention")] != "iso") continue;
    std::vector<std::size_t> rows;
    for (const char* name : {"iX", "iY", "iZ", "iA", "iB", "iC"}) {
      rows.push_back(static_cast<std::size_t>(std::stoul(row[column(name)])) - 1);
    }
    const std::string& unit = row[column("angle_unit")];
    const WangAngleUnit angles = unit == "deg"    ? WangAngleUnit::degrees
                                 : unit == "mdeg" ? WangAngleUnit::millidegrees
                                                  : WangAngleUnit::none;
    PoseList poses;
    poses.append(wang_positions(rows));
    const WangMap map = wang_map(wang_errors({.angles = angles, .composition = {}, .rows = 12}), poses);
    for (std::size_t d = 0; d < 3; ++d) {
      EXPECT_NEAR(map.error[d][0], std::stod(row[column("E_x") + d]), 2e-9) << line;
      EXPECT_NEAR(map.machining_point[d][0], std::stod(row[column("Tid_x") + d]) - std::stod(row[column("Wid_x") + d]),
                  2e-9);
    }
    EXPECT_NEAR(map.norm[0], std::stod(row[column("E_norm")]), 2e-9);
    ++compared;
  }
  EXPECT_GT(compared, 20U);
}

TEST(WangIntegrated, PosesOfTheMapAreMeasuredPositionsSoItsLargestIsNotAboveThatOfAll) {
  const WangMap map = wang_grid_map(wang_errors({}));
  ASSERT_EQ(map.norm.size(), 4096U);
  constexpr std::size_t kTables[] = {5, 0, 2, 3, 1, 4};  // chain order C X Z A Y B
  for (std::size_t k = 0; k < map.norm.size(); k += 7) {
    for (std::size_t i = 0; i < 6; ++i) EXPECT_LT(row_of(kTables[i], map.poses.axis[i][k]), 11U);
  }
  // What the file says is what was computed, in um.
  const MapData data = wang_map_data(map);
  EXPECT_EQ(data.fields.back().name, "E");
  EXPECT_EQ(data.fields.back().components[2], map.error[2]);
  const std::string csv = map_csv(data);
  EXPECT_NE(csv.find("E_x_um,E_y_um,E_z_um"), std::string::npos) << csv.substr(0, 200);
  // The page must not call it the volumetric error.
  EXPECT_EQ(wang_report_map(map, "grid")["quantity"], "integrated error E of equation (18)");
}

TEST(WangIntegrated, CovarianceIsThatOfCentralDifferences) {
  ErrorSet errors = wang_errors({.angles = WangAngleUnit::millidegrees, .composition = {}});
  const std::vector<double> values = errors.parameters();
  const auto count = static_cast<Eigen::Index>(values.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index p = 0; p < count; ++p) {
    covariance(p, p) = 1e-12 * (1 + static_cast<double>(p % 7));
    if (p > 0) covariance(p, p - 1) = covariance(p - 1, p) = 0.3e-12;
  }
  const Machine machine = wang_machine();
  std::vector<double> pose = wang_positions({2, 3, 4, 5, 6, 7});
  pose[1] += 13;  // between two positions of the tables
  Eigen::MatrixXd slopes(3, count);
  for (Eigen::Index p = 0; p < count; ++p) {
    constexpr double kStep = 1e-5;
    Eigen::Vector3d sides[2];
    for (const int side : {0, 1}) {
      std::vector<double> moved = values;
      moved[static_cast<std::size_t>(p)] += side == 0 ? kStep : -kStep;
      errors.set_parameters(moved);
      sides[side] = wang_integrated_error(machine, errors, pose).machine;
    }
    slopes.col(p) = (sides[0] - sides[1]) / (2 * kStep);
  }
  errors.set_parameters(values);
  const Eigen::Matrix3d wanted = slopes * covariance * slopes.transpose();
  const Eigen::Matrix3d found = WangIntegratedPlan(machine, errors).covariance_at(pose, covariance);
  EXPECT_LT((found - wanted).norm(), 1e-7 * wanted.norm());
}

TEST(WangFigures, EveryReadingOfFigure13Has36PointsWithinTheTravels) {
  const std::vector<WangPoints> sets = wang_points();
  ASSERT_EQ(sets.size(), 3U);
  const Machine machine = wang_machine();
  for (const WangPoints& set : sets) {
    ASSERT_EQ(set.degrees.norm.size(), 36U) << set.name;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      for (const double position : set.degrees.poses.axis[i]) {
        EXPECT_GE(position, machine.axes[i].travel_min) << set.name;
        EXPECT_LE(position, machine.axes[i].travel_max) << set.name;
      }
    }
  }
  // The first of the lines is the zero pose.
  EXPECT_NEAR(sets[1].no_angles.norm[0], Eigen::Vector3d(0.001, 0.0027, 0.003).norm(), 1e-12);
  // The circle is one: its machining points have one distance from their middle.
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  const auto& p = sets[0].degrees.machining_point;
  for (std::size_t i = 0; i < 36; ++i) middle += Eigen::Vector2d(p[0][i], p[1][i]) / 36;
  for (std::size_t i = 0; i < 36; ++i) EXPECT_NEAR((Eigen::Vector2d(p[0][i], p[1][i]) - middle).norm(), 100, 1e-9);
  const std::string csv = reproduction_csv(wang_point_table(sets));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 3 * 36);
  EXPECT_EQ(csv.find(",-0,"), std::string::npos);
  // E is rounded to a picometre after it is in um: 1.2, not 1.2000000000000002.
  std::size_t decimals = 0;
  for (std::size_t at = csv.find('.'); at != std::string::npos; at = csv.find('.', at + 1)) {
    decimals = std::max(decimals, csv.find_first_not_of("0123456789", at + 1) - at - 1);
  }
  EXPECT_EQ(decimals, 6U);
}

TEST(WangFigures, WhetherAConclusionHoldsFollowsFromTheFigures) {
  WangConclusions c;
  c.complete_degrees = c.angles_degrees = 10;
  c.complete_millidegrees = c.displacements = 0.015;
  c.angles_millidegrees = 0.011;
  c.largest_millidegrees = 0.05;
  c.sizes = {{0.5, 7, 0.013, 0.012}, {1, 11, 0.016, 0.012}, {2, 20, 0.022, 0.012}};
  const auto holds = [](const WangConclusions& conclusions, std::size_t row) {
    return wang_conclusion_rows(conclusions)[row][3];
  };
  EXPECT_EQ(holds(c, 0),
            "no, in neither unit; 0 % of the poses lie between 0.32 and 3.2 mm in degrees, and the largest error in "
            "millidegrees is 0.05 mm");
  EXPECT_EQ(wang_conclusions_json(c)["largest_millidegrees_um"], 50);
  EXPECT_EQ(holds(c, 1), "no, in neither unit");
  EXPECT_EQ(holds(c, 2), "only with the angles in degrees as printed");
  EXPECT_EQ(holds(c, 3), "yes, in both units; the error by the displacements only does not depend on the size");
  c.complete_degrees = 2;
  c.complete_millidegrees = 0.12;
  c.angles_millidegrees = 0.02;
  c.sizes[0] = {0.5, 21, 0.013, 0.013};
  EXPECT_TRUE(holds(c, 0).starts_with("only with the angles in degrees as printed; "));
  EXPECT_EQ(holds(c, 1), "only with the angles in millidegrees");
  EXPECT_EQ(holds(c, 2), "yes, in both units");
  EXPECT_EQ(holds(c, 3), "only with the angles in millidegrees; the error by the displacements only becomes smaller");
}

TEST(WangFigures, OfTheOrderOfMeansWithinAFactorOfTheRootOfTen) {
  for (const double order : {1.0, 10.0}) {
    EXPECT_TRUE(is_of_the_order(0.32 * order, order) && is_of_the_order(3.1 * order, order));
    EXPECT_FALSE(is_of_the_order(0.31 * order, order) || is_of_the_order(3.2 * order, order));
  }
}

TEST(WangFigures, SizeOfTheStructureCountsForTheAnglesAlone) {
  const std::vector<WangSize> sizes = wang_sizes();
  EXPECT_NEAR(sizes[0].no_angles, sizes[2].no_angles, 1e-12);
  EXPECT_GT(sizes[2].degrees, 1.3 * sizes[0].degrees);
  EXPECT_GT(sizes[2].millidegrees, sizes[1].millidegrees);
  EXPECT_NEAR(sizes[1].degrees, wang_grid_map(wang_errors({})).statistics.mean, 1e-12);
}

}  // namespace
}  // namespace abbe
