#include "abbe/study/imports/imported_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/geometry/rotation.h"
#include "abbe/study/example_file_for_test.h"
#include "abbe/study/imports/frame_sense.h"

namespace abbe {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

ImportRequest request_for_text(const std::string& text) {
  ImportRequest request;
  request.file = "t.txt";
  request.text = decode_foreign_text(text, request.file);
  return request;
}

/// Poses of a trunnion mill and where a tracker on its table sees a reflector beside the tool tip.
/// @param left_handed  the y of the tracker is reversed
MeasurementTable seen_by_a_tracker(const Machine& machine, bool left_handed) {
  MeasurementTable table;
  table.stations = {""};
  table.reflectors = {"R"};
  TrackerReadings& readings = table.readings;
  const RigidTransform tracker_from_bed = {rotation_from_vector({0.3, -0.5, 1.1}), {1500, -700, 300}};
  for (int i = 0; i < 60; ++i) {
    std::vector<double> pose;
    for (std::size_t k = 0; k < machine.axes.size(); ++k) {
      const Axis& axis = machine.axes[k];
      const double share = std::fmod(0.137 + 0.618 * (i + 1) * static_cast<double>(k + 1), 1.0);
      pose.push_back(axis.endless ? 6 * share : axis.travel_min + share * (axis.travel_max - axis.travel_min));
    }
    Eigen::Vector3d point =
        tracker_from_bed * (nominal_workpiece_from_tool(machine, pose) * Eigen::Vector3d(60, 20, -40));
    if (left_handed) point.y() = -point.y();
    readings.poses.append(pose);
    readings.station.push_back(0);
    readings.reflector.push_back(0);
    for (Eigen::Index k = 0; k < 3; ++k) readings.measured[static_cast<std::size_t>(k)].push_back(point[k]);
  }
  return table;
}

TEST(FrameSenseOfReadings, IsFoundWithAnUnknownOffsetOnAFiveAxisMachine) {
  const Machine machine = read_machine(test::example_file("machines/trunnion-mill.machine.toml"));
  const FrameSense right = frame_sense(machine, seen_by_a_tracker(machine, false));
  EXPECT_TRUE(right.is_right());
  EXPECT_TRUE(right.is_proof());
  EXPECT_LT(right.right_mm, 0.01);
  EXPECT_GT(right.left_mm, 10);
  FrameSense few = right;
  few.readings = 5;
  EXPECT_FALSE(few.is_proof());
  const FrameSense left = frame_sense(machine, seen_by_a_tracker(machine, true));
  EXPECT_TRUE(left.is_left());
  EXPECT_NEAR(left.left_mm, right.right_mm, 1e-6);
}

TEST(FrameSenseOfReadings, IsNotFoundFromPointsInAPlane) {
  const Machine machine = read_machine(test::example_file("machines/three-axis-mill.machine.toml"));
  MeasurementTable table;
  table.stations = {""};
  table.reflectors = {"R"};
  for (int i = 0; i < 20; ++i) {
    const double x = 30 * i, y = 10 * (i % 5);
    table.readings.poses.append({x, y, -100});
    table.readings.station.push_back(0);
    table.readings.reflector.push_back(0);
    table.readings.measured[0].push_back(x);
    table.readings.measured[1].push_back(y);
    table.readings.measured[2].push_back(5);
  }
  const FrameSense sense = frame_sense(machine, table);
  EXPECT_FALSE(sense.is_right());
  EXPECT_FALSE(sense.is_left());
  EXPECT_FALSE(sense.is_proof());
  EXPECT_EQ(frame_sense(machine, MeasurementTable()).extent_mm, 0);
}

TEST(ImportedTableOfARequest, IsTheSameByTheMappingThatItProposes) {
  ImportRequest request;
  request.file = test::example_file("import/total-station.txt");
  request.text = read_foreign_text(request.file);
  request.machine = read_machine(test::example_file("machines/three-axis-mill.machine.toml"));
  const ImportedTable first = [&] { return import_table(request); }();
  EXPECT_TRUE(first.is_certain());
  EXPECT_EQ(first.mapping.kind, ImportKind::tracker);
  ImportRequest again = request;
  again.mapping = parse_import_mapping(imported_mapping_text(first), "m.import.toml");
  const ImportedTable second = import_table(again);
  EXPECT_EQ(second.rows.csv, first.rows.csv);
  EXPECT_THAT(second.doubts(), IsEmpty());
  // The mapping of the examples is that one.
  again.mapping = read_import_mapping(test::example_file("import/total-station.import.toml"));
  EXPECT_EQ(import_table(again).rows.csv, first.rows.csv);
  // Clockwise is what it is; the other sense is contradicted by the commands.
  request.hints.clockwise = false;
  const ImportedTable wrong = import_table(request);
  ASSERT_THAT(wrong.doubts(), SizeIs(1));
  EXPECT_THAT(wrong.doubts()[0], HasSubstr("azimuth_deg: the nominal machine fits to 0.01"));
  EXPECT_THAT(wrong.doubts()[0], HasSubstr("only with it reversed"));
}

/// The rows of the example of a total station without what stands above them.
/// @param range_first  the last column comes before the angles
std::string rows_without_header(bool range_first) {
  const std::string text = read_foreign_text(test::example_file("import/total-station.txt")).text;
  std::string rows;
  for (std::size_t at = text.find("P1;"); at < text.size();) {
    const std::size_t end = text.find('\n', at);
    std::string line = text.substr(at, end - at);
    if (line.ends_with('\r')) line.pop_back();
    if (range_first) {
      const std::size_t range = line.rfind(';'), angles = line.rfind(';', line.rfind(';', range - 1) - 1);
      line = line.substr(0, angles) + line.substr(range) + line.substr(angles, range - angles);
    }
    rows += line + '\n';
    at = end == std::string::npos ? text.size() : end + 1;
  }
  return rows;
}

TEST(ImportedTableOfARequest, WithoutNamesIsPolarWhereThatFitsTheMachine) {
  ImportRequest request;
  request.file = test::example_file("import/total-station.txt");
  request.text = read_foreign_text(request.file);
  request.machine = read_machine(test::example_file("machines/three-axis-mill.machine.toml"));
  const std::string expected = import_table(request).rows.csv;
  for (const bool range_first : {false, true}) {
    request.text = decode_foreign_text(rows_without_header(range_first), "t.txt");
    const ImportedTable result = import_table(request);
    EXPECT_TRUE(result.is_certain()) << imported_table_text(result);
    EXPECT_EQ(result.rows.csv, expected);
    EXPECT_THAT(imported_table_text(result),
                HasSubstr(range_first ? "the last three numbers are range, azimuth and elevation: so the nominal "
                                        "machine fits to 0.01"
                                      : "the last three numbers are azimuth, elevation and range: so the nominal "
                                        "machine fits to 0.01"));
    const ImportMapping mapping = parse_import_mapping(imported_mapping_text(result), "m.import.toml");
    ImportRequest again = request;
    again.mapping = mapping;
    EXPECT_EQ(import_table(again).rows.csv, expected);
  }
  request.hints.clockwise = true;
  EXPECT_EQ(import_table(request).rows.csv, expected);
  // Coordinates stay coordinates, and have no azimuth.
  request.text = decode_foreign_text(
      "0 0 0 1 2 3\n100 0 0 101 2 3\n0 100 0 1 102 3\n0 0 -100 1 2 -97\n100 100 0 101 102 3\n0 100 -50 1 102 -47\n"
      "100 0 -30 101 2 -27\n",
      "t.txt");
  EXPECT_THAT(message_of([&] { import_table(request); }), HasSubstr("--azimuth: the table has no azimuth"));
  request.hints.clockwise.reset();
  EXPECT_EQ(import_table(request).mapping.columns[3].name, "measured_x_mm");
}

TEST(ImportedTableOfARequest, NominalAndMeasuredAreCommandsAndReadingsOfATracker) {
  ImportRequest request;
  request.file = test::example_file("import/nominal-measured.csv");
  const std::string text = read_foreign_text(request.file).text;
  request.machine = read_machine(test::example_file("machines/three-axis-mill.machine.toml"));
  std::string first;
  for (const char* const header :
       {"Name,NomX,NomY,NomZ,MeasX,MeasY,MeasZ", "Name,Nom X,Nom Y,Nom Z,Meas X,Meas Y,Meas Z",
        "Name,Xnom,Ynom,Znom,Xact,Yact,Zact", "Name,X_nom,Y_nom,Z_nom,X_act,Y_act,Z_act",
        "Point,X-Nominal,Y-Nominal,Z-Nominal,X-Measured,Y-Measured,Z-Measured",
        "Punkt,SollX,SollY,SollZ,IstX,IstY,IstZ", "NAME,NOMX,NOMY,NOMZ,MEASX,MEASY,MEASZ"}) {
    request.text = decode_foreign_text(header + text.substr(text.find('\n')), "t.csv");
    const ImportedTable result = import_table(request);
    EXPECT_TRUE(result.is_certain()) << imported_table_text(result);
    if (first.empty()) first = result.rows.csv;
    EXPECT_EQ(result.rows.csv, first) << header;
  }
  EXPECT_THAT(first, HasSubstr("point,X_mm,Y_mm,Z_mm,measured_x_mm,measured_y_mm,measured_z_mm\nP1,60.0,40.0,-400.0,"
                               "1041.252,860.582,-670.002\n"));
}

TEST(ImportedTableOfARequest, OfAnotherEncodingKeepsItInItsMapping) {
  ImportRequest request;
  request.file = "t.txt";
  request.text = decode_foreign_text("x_mm;y_mm;z_mm;point\n1,5;2;3;\xC2\xB5\n", "t.txt",
                                     {.encoding = TextEncoding::windows_1252});
  const ImportedTable result = import_table(request);
  EXPECT_EQ(result.rows.csv, "point,x_mm,y_mm,z_mm\nÂµ,1.5,2,3\n");
  EXPECT_EQ(parse_import_mapping(imported_mapping_text(result), "m").encoding, TextEncoding::windows_1252);
}

TEST(ImportedTableOfARequest, SaysWhatIsInDoubtAndWhatWasAccepted) {
  ImportRequest request = request_for_text("x;y;z\n1,5;2;3\n");
  const ImportedTable doubted = import_table(request);
  EXPECT_FALSE(doubted.is_certain());
  EXPECT_THAT(doubted.doubts(), SizeIs(3));
  EXPECT_THAT(imported_table_text(doubted), HasSubstr("UNCERTAIN: states no unit"));
  EXPECT_FALSE(imported_table_json(doubted).at("certain").get<bool>());
  request.accept_doubts = true;
  const ImportedTable accepted = import_table(request);
  EXPECT_TRUE(accepted.is_certain());
  EXPECT_THAT(imported_table_text(accepted), HasSubstr("accepted: states no unit"));
  EXPECT_EQ(accepted.rows.csv, doubted.rows.csv);
}

TEST(ImportedTableOfARequest, RefusesKindsThatContradictAndMissingMachines) {
  ImportRequest request = request_for_text("x_mm,y_mm,z_mm\n1.5,2,3\n");
  request.mapping = import_table(request).mapping;
  request.kind = ImportKind::positioning;
  EXPECT_EQ(message_of([&] { import_table(request); }),
            "--as: is not the kind of the mapping, points; expected the same kind, or no --as");
  request.kind.reset();
  request.mapping->kind = ImportKind::tracker;
  EXPECT_THAT(message_of([&] { import_table(request); }), HasSubstr("--machine: is missing"));
}

}  // namespace
}  // namespace abbe
