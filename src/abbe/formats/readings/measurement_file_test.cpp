#include "abbe/formats/readings/measurement_file.h"

#include <gtest/gtest.h>

#include <random>

#include "abbe/formats/controls/turntable_machine_for_test.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

MeasurementTable parsed_measurements(const std::string& text, const ColumnMapping& mapping = {}) {
  MeasurementOptions options;
  options.mapping = mapping;
  return parse_measurements(text, "r.csv", test::one_turn_turntable(), options);
}

std::string message_of_measurements(const std::string& text, const ColumnMapping& mapping = {}) {
  return message_of([&] { parsed_measurements(text, mapping); });
}

TEST(MeasurementFile, ReadsForeignFilesByMapping) {
  // First rows of the synthetic readings after Aguado et al. and their header.
  const MeasurementTable table = parsed_measurements(
      "x_mm,z_mm,c_deg,Tx_mm,Ty_mm,Tz_mm,XLT_x_mm,XLT_y_mm,XLT_z_mm\n"
      "179.998283877,148.866651183,310.0,0.0,80.0,-250.0,-188.365369188,848.639082374,127.123782272\n"
      "698.989007416,286.214466042,300.0,-70.0,-30.0,-100.0,-190.294671161,402.387784930,428.292218361\n"
      "1,2,3,0,80,-250,4,5,6\n",
      {{{"X_mm", "x_mm"},
        {"Z_mm", "z_mm"},
        {"C_deg", "c_deg"},
        {"offset_x_mm", "Tx_mm"},
        {"offset_y_mm", "Ty_mm"},
        {"offset_z_mm", "Tz_mm"},
        {"measured_x_mm", "XLT_x_mm"},
        {"measured_y_mm", "XLT_y_mm"},
        {"measured_z_mm", "XLT_z_mm"}},
       {}});
  ASSERT_EQ(table.readings.count(), 3U);
  EXPECT_DOUBLE_EQ(table.readings.poses.axis[0][0], 310 * 3.14159265358979323846 / 180);
  EXPECT_EQ(table.readings.poses.axis[1][0], 179.998283877);
  EXPECT_EQ(table.readings.poses.axis[2][1], 286.214466042);
  EXPECT_EQ(table.reflectors, (std::vector<std::string>{"offset1", "offset2"}));
  EXPECT_EQ(table.reflector_offset[1], Eigen::Vector3d(-70, -30, -100));
  EXPECT_EQ(table.readings.reflector, (std::vector<std::uint16_t>{0, 1, 0}));
  EXPECT_EQ(table.readings.measured[2][1], 428.292218361);
  EXPECT_EQ(table.readings.measure, TrackerMeasure::cartesian);
  EXPECT_EQ(table.readings.stated, StatedUncertainty::none);
}

TEST(MeasurementFile, ReadsRangeAnglesNamesUncertaintiesAndTime) {
  const MeasurementTable table = parsed_measurements(
      "time_s,station,reflector,X_mm,Z_mm,C_deg,range_m,azimuth_deg,elevation_rad,u_range_um,u_azimuth_arcsec,"
      "u_elevation_urad\n0,S2,T1,0,0,0,1.5,90,0.1,5,1,5\n2.5,S1,T1,1,1,1,1.5,90,0.1,5,1,5\n");
  EXPECT_EQ(table.readings.measure, TrackerMeasure::range_and_angles);
  EXPECT_EQ(table.readings.measured[0][0], 1500);
  EXPECT_DOUBLE_EQ(table.readings.measured[1][0], 3.14159265358979323846 / 2);
  EXPECT_EQ(table.readings.stated, StatedUncertainty::standard);
  EXPECT_EQ(table.readings.uncertainty[0][0], 0.005);
  EXPECT_EQ(table.readings.uncertainty[2][0], 5e-6);
  EXPECT_EQ(table.stations, (std::vector<std::string>{"S2", "S1"}));
  EXPECT_EQ(table.readings.station, (std::vector<std::uint16_t>{0, 1}));
  EXPECT_EQ(table.readings.time_s, (std::vector<double>{0, 2.5}));
}

TEST(MeasurementFile, ReadsBackWhatItWrites) {
  std::mt19937_64 generator(6);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const bool cartesian : {true, false}) {
    for (const StatedUncertainty stated :
         {StatedUncertainty::none, StatedUncertainty::standard, StatedUncertainty::covariance}) {
      MeasurementTable table;
      TrackerReadings& readings = table.readings;
      readings.measure = cartesian ? TrackerMeasure::cartesian : TrackerMeasure::range_and_angles;
      readings.stated = stated;
      table.stations = {"A", "b, c"};
      table.reflectors = {"T \"1\"", "#2"};
      table.reflector_offset = {{1 / 3.0, 2, 3}, {0, -0.1, 1e-7}};
      readings.poses.axis.resize(3);
      for (int i = 0; i < 100; ++i) {
        const double travel[3] = {6.28, 1400, 600};
        for (std::size_t k = 0; k < 3; ++k) readings.poses.axis[k].push_back(travel[k] * uniform(generator));
        for (std::size_t k = 0; k < 3; ++k) readings.measured[k].push_back(0.1 + uniform(generator));
        for (std::size_t k = 0; k < 6; ++k)
          readings.uncertainty[k].push_back((k < 3 ? 1e-3 : 1e-4) * (1 + uniform(generator)));
        readings.station.push_back(i % 3 == 1);
        readings.reflector.push_back(i % 2 == 1);
        readings.time_s.push_back(uniform(generator));
      }
      if (stated == StatedUncertainty::none) readings.uncertainty = {};
      if (stated == StatedUncertainty::standard) {
        for (std::size_t k = 3; k < 6; ++k) readings.uncertainty[k].clear();
      }
      const std::string text = measurements_text(test::one_turn_turntable(), table);
      const MeasurementTable back = parsed_measurements(text);
      EXPECT_EQ(back.readings.poses.axis[1], readings.poses.axis[1]);
      EXPECT_EQ(back.readings.poses.axis[2], readings.poses.axis[2]);
      for (std::size_t i = 0; i < 100; ++i) {
        ASSERT_DOUBLE_EQ(back.readings.poses.axis[0][i], readings.poses.axis[0][i]);
        for (std::size_t k = 0; k < 3; ++k) ASSERT_DOUBLE_EQ(back.readings.measured[k][i], readings.measured[k][i]);
        for (std::size_t k = 0; k < 6; ++k) {
          ASSERT_EQ(back.readings.uncertainty[k].size(), readings.uncertainty[k].size());
          if (!readings.uncertainty[k].empty()) {
            ASSERT_DOUBLE_EQ(back.readings.uncertainty[k][i], readings.uncertainty[k][i]);
          }
        }
      }
      if (cartesian) {
        EXPECT_EQ(back.readings.measured, readings.measured);
      }
      EXPECT_EQ(back.readings.measured[0], readings.measured[0]);
      EXPECT_EQ(back.stations, table.stations);
      EXPECT_EQ(back.reflectors, table.reflectors);
      EXPECT_EQ(back.reflector_offset, table.reflector_offset);
      EXPECT_EQ(back.readings.station, readings.station);
      EXPECT_EQ(back.readings.reflector, readings.reflector);
      EXPECT_EQ(back.readings.time_s, readings.time_s);
    }
  }
}

TEST(MeasurementFile, RefusesPosesOutsideTheTravel) {
  const std::string text =
      "X_mm,Z_mm,C_deg,measured_x_mm,measured_y_mm,measured_z_mm\n# c\n1,2,3,4,5,6\n1,601,3,4,5,6\n";
  EXPECT_EQ(message_of_measurements(text),
            "r.csv:4: Z_mm: 601 mm is outside the travel of axis Z; expected 0 to 600 mm");
  MeasurementOptions options;
  options.check_travel = false;
  EXPECT_EQ(parse_measurements(text, "r.csv", test::one_turn_turntable(), options).readings.count(), 2U);
  EXPECT_EQ(message_of([] { parse_poses("X_mm,Z_mm,C_deg\n1,2,361\n", "p.csv", test::one_turn_turntable()); }),
            "p.csv:2: C_deg: 361 deg is outside the travel of axis C; expected 0 to 360 deg");
}

TEST(MeasurementFile, RefusesMissingAndContradictoryColumns) {
  EXPECT_EQ(message_of_measurements("X_mm,C_deg,measured_x_mm,measured_y_mm,measured_z_mm\n1,2,3,4,5\n"),
            "r.csv:1: Z: missing column; expected Z_mm, Z_um or Z_m");
  EXPECT_EQ(message_of_measurements("X_mm,Y_mm,Z_mm,C_deg,measured_x_mm,measured_y_mm,measured_z_mm\n1,2,3,4,5,6,7\n"),
            "r.csv:1:6: Y_mm: unknown column; expected one of C, X, Z, station, reflector, offset_x, offset_y, "
            "offset_z, measured_x, measured_y, measured_z, range, ...");
  EXPECT_EQ(message_of_measurements("X_mm,Z_mm,C_deg,measured_x_mm,measured_y_mm\n1,2,3,4,5\n"),
            "r.csv: measured_z: missing column; expected measured_z_mm, measured_z_um or measured_z_m");
  EXPECT_EQ(message_of_measurements("X_mm,Z_mm,C_deg\n1,2,3\n"),
            "r.csv: measured_x: missing column; expected measured_x_mm, measured_y_mm, measured_z_mm or range_mm, "
            "azimuth_deg, elevation_deg");
  EXPECT_EQ(
      message_of_measurements(
          "X_mm,Z_mm,C_deg,measured_x_mm,measured_y_mm,measured_z_mm,u_range_um,u_azimuth_deg,u_elevation_deg\n"
          "1,2,3,4,5,6,7,8,9\n"),
      "r.csv: u_range_um: does not belong to what was measured; expected u_x_um, u_y_um, u_z_um or cov_xx_um2, ...");
}

TEST(MeasurementFile, RefusesCovariancesThatAreNoneAndReflectorsThatMove) {
  const std::string start = "X_mm,Z_mm,C_deg,measured_x_mm,measured_y_mm,measured_z_mm,";
  EXPECT_EQ(message_of_measurements(
                start + "cov_xx_um2,cov_xy_um2,cov_xz_um2,cov_yy_um2,cov_yz_um2,cov_zz_um2\n1,2,3,4,5,6,1,2,0,1,0,1\n"),
            "r.csv:2: cov_xy_um2: implies a correlation of 2 given cov_xx_um2 and cov_yy_um2; expected a positive "
            "definite covariance: correlations between -1 and 1");
  EXPECT_EQ(message_of_measurements(
                start + "cov_xx_um2,cov_xy_um2,cov_xz_um2,cov_yy_um2,cov_yz_um2,cov_zz_um2\n1,2,3,4,5,6,0,0,0,1,0,1\n"),
            "r.csv:2:13: cov_xx_um2: is 0; expected a squared length in um2 above zero");
  EXPECT_EQ(message_of_measurements(
                start + "reflector,offset_x_mm,offset_y_mm,offset_z_mm\n1,2,3,4,5,6,T1,0,0,0\n1,2,3,4,5,6,T1,0,0,1\n"),
            "r.csv:3: offset_x_mm: reflector T1 had another offset in an earlier row; expected (0, 0, 0) mm");
}

const char* const kPolarCovariance =
    "X_mm,Z_mm,C_deg,range_mm,azimuth_deg,elevation_deg,cov_range_range_um2,cov_azimuth_azimuth_arcsec2,"
    "cov_elevation_elevation_arcsec2,cov_range_azimuth_um_arcsec,cov_range_elevation_um_arcsec,"
    "cov_azimuth_elevation_arcsec2\n";

TEST(MeasurementFile, ReadsCovariancesOfRangeAndAngles) {
  const MeasurementTable table =
      parsed_measurements(std::string(kPolarCovariance) + "1,2,3,1500,90,10,25,4,1,-5,2,0.5\n");
  EXPECT_EQ(table.readings.stated, StatedUncertainty::covariance);
  const double arcsec = 3.14159265358979323846 / 648000;
  const auto& c = table.readings.uncertainty;
  EXPECT_DOUBLE_EQ(c[0][0], 25e-6);
  EXPECT_DOUBLE_EQ(c[1][0], 4 * arcsec * arcsec);
  EXPECT_DOUBLE_EQ(c[2][0], arcsec * arcsec);
  EXPECT_DOUBLE_EQ(c[3][0], -5e-3 * arcsec);
  EXPECT_DOUBLE_EQ(c[4][0], 2e-3 * arcsec);
  EXPECT_DOUBLE_EQ(c[5][0], 0.5 * arcsec * arcsec);

  // The same matrix in other units.
  const MeasurementTable other = parsed_measurements(
      "X_mm,Z_mm,C_deg,range_mm,azimuth_deg,elevation_deg,cov_range_range_mm2,cov_azimuth_azimuth_urad2,"
      "cov_elevation_elevation_rad2,cov_range_azimuth_um_urad,cov_range_elevation_mm_rad,cov_azimuth_elevation_mrad2\n"
      "1,2,3,1500,90,10,25e-6,94,24e-12,-24,1e-9,1e-5\n");
  EXPECT_DOUBLE_EQ(other.readings.uncertainty[0][0], 25e-6);
  EXPECT_DOUBLE_EQ(other.readings.uncertainty[1][0], 94e-12);
  EXPECT_DOUBLE_EQ(other.readings.uncertainty[3][0], -24e-9);
  EXPECT_DOUBLE_EQ(other.readings.uncertainty[4][0], 1e-9);
  EXPECT_DOUBLE_EQ(other.readings.uncertainty[5][0], 1e-11);
}

TEST(MeasurementFile, RefusesCovariancesOfRangeAndAnglesThatAreNone) {
  const std::string start = kPolarCovariance;
  EXPECT_EQ(
      message_of_measurements(start + "# c\n1,2,3,1500,90,10,25,4,1,-5,2,0.5\n1,2,3,1500,90,10,25,4,1,-5,5.5,0.5\n"),
      "r.csv:4: cov_range_elevation_um_arcsec: implies a correlation of 1.1 given cov_range_range_um2 and "
      "cov_elevation_elevation_arcsec2; expected a positive definite covariance: correlations between -1 and 1");
  EXPECT_EQ(message_of_measurements(start + "1,2,3,1500,90,10,25,4,1,9,4.5,-1.8\n"),
            "r.csv:2: cov_range_range_um2: the covariance of this reading is not positive definite; expected "
            "consistent correlations");
  EXPECT_EQ(message_of_measurements(start + "1,2,3,1500,90,10,25,-4,1,0,0,0\n"),
            "r.csv:2:21: cov_azimuth_azimuth_arcsec2: is -4; expected a squared angle in arcsec2 above zero");
  EXPECT_EQ(
      message_of_measurements(start + "1,2,3,1500,90,90,25,4,1,0,0,0\n"),
      "r.csv:2: elevation_deg: the beam is vertical, where an uncertainty of the azimuth has no meaning; expected "
      "an elevation between -90 and 90 deg, or no columns of uncertainty");
  EXPECT_EQ(message_of_measurements(
                "X_mm,Z_mm,C_deg,range_mm,azimuth_deg,elevation_deg,cov_range_range_um2,cov_range_azimuth_um2\n"
                "1,2,3,4,5,6,7,8\n"),
            "r.csv:1:72: cov_range_azimuth_um2: 'um2' is not a unit of a length times an angle; expected "
            "cov_range_azimuth_mm_rad, cov_range_azimuth_um_urad, cov_range_azimuth_um_arcsec or "
            "cov_range_azimuth_mm_arcsec");
  EXPECT_EQ(message_of_measurements(
                "X_mm,Z_mm,C_deg,range_mm,azimuth_deg,elevation_deg,cov_range_range_um2\n1,2,3,4,5,6,7\n"),
            "r.csv: cov_azimuth_elevation: missing column; expected cov_azimuth_elevation_rad2, "
            "cov_azimuth_elevation_mrad2, cov_azimuth_elevation_urad2, cov_azimuth_elevation_deg2 or "
            "cov_azimuth_elevation_arcsec2");
  EXPECT_EQ(message_of_measurements("X_mm,Z_mm,C_deg,range_mm,azimuth_deg,elevation_deg,cov_xx_um2\n1,2,3,4,5,6,7\n"),
            "r.csv: cov_xx_um2: does not belong to what was measured; expected u_range_um, u_azimuth_arcsec, "
            "u_elevation_arcsec or cov_range_range_um2, ...");
}

TEST(MeasurementFile, SaysWhichFileIsMissing) {
  EXPECT_EQ(message_of([] { read_measurements("no/such.csv", test::one_turn_turntable()); }),
            "no/such.csv: there is no such file");
  EXPECT_EQ(message_of([] { read_measurements("/dev/zero", test::one_turn_turntable()); }),
            "/dev/zero: is not a regular file");
}

}  // namespace
}  // namespace abbe
