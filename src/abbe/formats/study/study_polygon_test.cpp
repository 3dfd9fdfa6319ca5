#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <filesystem>

#include "abbe/formats/controls/turntable_machine_for_test.h"
#include "abbe/formats/files/text_file.h"
#include "abbe/formats/readings/instrument_file.h"
#include "abbe/formats/study/study_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/formats/text/replaced_text_for_test.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/instruments/polygon/polygon_gauge.h"

namespace abbe {
namespace {

const char* const kPolygonStudy = R"(machine = "m.machine.toml"
[simulate]
[simulate.generator]
mean_volumetric_um = 100
[[setup]]
name = "prism"
instrument = "polygon"
rotary_axis = "C"
centre_mm = [0, 0, 20]
aligned_at = { C_deg = 30, X_mm = 100 }
noise = { angle_arcsec = 0.05, displacement_um = 0.03 }
zero = { displacement_x_um = 3, autocollimator_y_about_x_arcsec = 2 }
[setup.prism]
faces = 12
distance_mm = 48.3
height_mm = 17
azimuth_error_arcsec = 0.5
azimuth_error_standard_uncertainty_arcsec = 1
estimate_tilt = false
distance_error_um = 2
[[setup.prism.face]]
number = 3
azimuth_error_arcsec = 0.31
true_azimuth_error_arcsec = 0.25
distance_error_um = -1
distance_error_standard_uncertainty_um = 0.2
[setup.sensor.displacement_z]
position_mm = [20, 0, 90]
[[setup.mount]]
name = "first"
x_um = 5
x_standard_uncertainty_um = 2
[[setup.mount]]
name = "second"
turned_by_faces = 1
true_tilt_x_arcsec = 4
[[setup.plan]]
kind = "grid"
axis.C = { range_deg = [0, 360], count = 13 }
axis.X = { at_mm = 100 }
items = ["second"]
)";

Study parsed_polygon_study(const std::string& text) {
  return parse_study(text, "s.study.toml", test::one_turn_turntable());
}

std::string polygon_study_with(const std::string& from, const std::string& to) {
  return test::replaced(kPolygonStudy, from, to);
}

std::string message_of_polygon_with(const std::string& from, const std::string& to) {
  const std::string text = polygon_study_with(from, to);
  return message_of([&] { parsed_polygon_study(text); });
}

const char* const kSteps = R"(
[[setup.step]]
name = "x"
autocollimator = "x"
displacement = "y"
[[setup.step]]
name = "y"
autocollimator = "y"
displacement = "x"
zero = { displacement_x_um = 7 }
[[setup.step]]
name = "z"
autocollimator = "y"
displacement = "z"
[setup.prism])";

std::string stepwise() {
  std::string text = polygon_study_with("[setup.prism]", kSteps);
  const std::size_t zero = text.find("zero = {");
  return text.erase(zero, text.find('\n', zero) + 1 - zero);
}

const SetupQuantity& named(const Instrument& device, const std::string& name) {
  for (const SetupQuantity& quantity : device.quantities()) {
    if (quantity.name == name) return quantity;
  }
  throw std::out_of_range(name);
}

TEST(StudyPolygon, ReadsAPrismWithWhatIsKnownOfIt) {
  const Study study = parsed_polygon_study(kPolygonStudy);
  const Instrument& device = *study.setups.at(0).device;
  EXPECT_EQ(device.quantities().size(), 12U + 36U + 2U + 6U);
  EXPECT_EQ(device.target_names(), (std::vector<std::string>{"first", "second"}));
  EXPECT_EQ(study.setups[0].plans.at(0).targets, std::vector<std::size_t>{1});
  const SetupQuantity& plain = named(device, "prism.face1.azimuth_error");
  EXPECT_DOUBLE_EQ(plain.value, 0.5 * kArcsec);
  EXPECT_EQ(plain.knowledge, Knowledge::within);
  EXPECT_DOUBLE_EQ(plain.standard_uncertainty, kArcsec);
  // A face of its own: what it does not state is that of all.
  const SetupQuantity& certified = named(device, "prism.face3.azimuth_error");
  EXPECT_DOUBLE_EQ(certified.value, 0.31 * kArcsec);
  EXPECT_DOUBLE_EQ(certified.standard_uncertainty, kArcsec);
  EXPECT_DOUBLE_EQ(certified.truth.value(), 0.25 * kArcsec);
  EXPECT_EQ(named(device, "prism.face3.tilt").knowledge, Knowledge::exact);
  // Distances count from the axis.
  EXPECT_EQ(named(device, "prism.face1.distance").knowledge, Knowledge::open);
  EXPECT_DOUBLE_EQ(named(device, "prism.face1.distance").value, 48.302);
  EXPECT_DOUBLE_EQ(named(device, "prism.face3.distance").value, 48.299);
  EXPECT_DOUBLE_EQ(named(device, "prism.face3.distance").standard_uncertainty, 2e-4);
  EXPECT_DOUBLE_EQ(named(device, "prism.first.x").standard_uncertainty, 2e-3);
  EXPECT_EQ(named(device, "prism.second.x").knowledge, Knowledge::open);
  EXPECT_DOUBLE_EQ(named(device, "prism.second.tilt_x").truth.value(), 4 * kArcsec);
  EXPECT_EQ(named(device, "prism.top.tilt_x").knowledge, Knowledge::exact);
  const auto& gauge = dynamic_cast<const PolygonGauge&>(device);
  EXPECT_EQ(gauge.setup().bench.displacement_z.position, Eigen::Vector3d(20, 0, 90));
  EXPECT_DOUBLE_EQ(gauge.setup().noise.length, 3e-5);
}

TEST(StudyPolygon, AZeroIsTheIndicationOfThePrismAtItsNominalPlace) {
  const Study study = parsed_polygon_study(polygon_study_with("distance_error_um = 2", "distance_error_um = 0"));
  const Instrument& device = *study.setups[0].device;
  std::vector<double> values;
  for (const SetupQuantity& quantity : device.quantities()) {
    const bool zero = quantity.name.find(".zero.") != std::string::npos;
    values.push_back(zero || quantity.name.find(".distance") != std::string::npos ? quantity.value : 0);
  }
  // Aligned at C = 30 deg, so that the first mount shows its first face there.
  const std::size_t item = device.item_at(study.machine, 0, 0, {30 * 3600 * kArcsec, 100, 0});
  EXPECT_EQ(device.items()[item].name, "first.face1");
  // C' turned by 30 deg carries the workpiece the other way; X' = 100 carries it to -100.
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rotation =
      Eigen::AngleAxisd(-30 * 3600 * kArcsec, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Vector3d origin(-100, 0, 0);
  ItemBlock block{item, 1, {}, {}, {}, values.data()};
  for (int i = 0; i < 9; ++i) block.rotation[i] = rotation.data() + i;
  for (int i = 0; i < 3; ++i) block.origin[i] = origin.data() + i;
  double reading[6];
  device.model(block, ModelledBlock{reading});
  EXPECT_NEAR(reading[0], 0, 1e-14);
  EXPECT_NEAR(reading[2], 2 * kArcsec, 1e-14);
  EXPECT_NEAR(reading[3], 3e-3, 1e-11);
  EXPECT_NEAR(reading[4], 0, 1e-11);
  EXPECT_NEAR(reading[5], 0, 1e-11);
}

TEST(StudyPolygon, StepsShareThePrismAndHaveZerosOfTheirOwn) {
  std::string renamed = stepwise();
  renamed.replace(renamed.find("items = [\"second\"]"), 18, "items = [\"second.y\"]");
  const Study steps = parsed_polygon_study(renamed);
  const Instrument& device = *steps.setups[0].device;
  EXPECT_EQ(device.target_names().size(), 6U);
  ASSERT_EQ(device.components().size(), 3U);
  EXPECT_EQ(device.components()[0].name, "autocollimator_about_z");
  EXPECT_EQ(device.quantities().size(), 12U + 36U + 2U + 9U);
  EXPECT_NEAR(named(device, "prism.y.zero.displacement_x").value - named(device, "prism.x.zero.displacement_y").value,
              7e-3, 1e-12);
  EXPECT_EQ(steps.setups[0].plans[0].targets, std::vector<std::size_t>{4});
}

TEST(StudyPolygon, AFileNamesTheMountAndThePoseSaysWhichFaceIsSeen) {
  const Study study = parsed_polygon_study(kPolygonStudy);
  const Instrument& device = *study.setups[0].device;
  const std::string header =
      "C_deg,X_mm,Z_mm,item,autocollimator_x_about_z_arcsec,autocollimator_x_about_y_arcsec,"
      "autocollimator_y_about_x_arcsec,displacement_x_um,displacement_y_um,displacement_z_um\n";
  const std::string text = header + "30,100,0,first,1,2,3,4,5,6\n60,100,0,second,1,2,3,4,5,6\n";
  const InstrumentReadings readings = parse_instrument_readings(text, "r.csv", study.machine, device);
  ASSERT_EQ(readings.count(), 2U);
  EXPECT_EQ(device.items()[readings.item[0]].name, "first.face1");
  // C' goes to the other side: a step later the face before it, but the second mount is turned on by one.
  EXPECT_EQ(device.items()[readings.item[1]].name, "second.face1");
  EXPECT_DOUBLE_EQ(readings.measured[3][0], 4e-3);
  const std::string written = instrument_readings_text(study.machine, device, readings);
  EXPECT_NE(written.find(",100,0,second,1,2,3,0.004,"), std::string::npos) << written;
  EXPECT_EQ(parse_instrument_readings(written, "w.csv", study.machine, device).item, readings.item);
  const auto message = [&](const std::string& row) {
    return message_of([&] { parse_instrument_readings(header + row, "r.csv", study.machine, device); });
  };
  EXPECT_EQ(message("30,100,0,third,1,2,3,4,5,6\n"),
            "r.csv:2: item: prism has no item 'third'; expected one of first, second");
  EXPECT_NE(message("45,100,0,first,1,2,3,4,5,6\n").find("r.csv:2: item: first: the nearest face looks 15 deg aside"),
            std::string::npos)
      << message("45,100,0,first,1,2,3,4,5,6\n");
  EXPECT_NE(message("30,114,0,first,1,2,3,4,5,6\n").find("misses the prism"), std::string::npos);
}

TEST(StudyPolygon, TheDocumentedSetUpsAreAccepted) {
  const std::string page = read_text_file(std::filesystem::path(ABBE_DOCS) / "polygon.md");
  const auto block = [&](const std::string& kind, std::size_t number) {
    std::size_t at = 0;
    for (std::size_t i = 0; i <= number; ++i) at = page.find("```" + kind + "\n", at) + kind.size() + 4;
    return page.substr(at, page.find("```", at) - at);
  };
  const std::string begin = "machine = \"m.machine.toml\"\n[simulate.generator]\nmean_volumetric_um = 100\n";
  const std::string plan = "[[setup.plan]]\nkind = \"grid\"\naxis.C = { range_deg = [0, 330], count = 12 }\n";
  const Machine table = parse_machine("name = \"m\"\nchain = \"w C' b t\"\n[axis.C]\nendless = true\n", "m");
  const Study study = parse_study(begin + block("toml", 0) + plan, "s", table);
  EXPECT_EQ(study.setups.at(0).plans.at(0).targets.size(), 2U);
  EXPECT_EQ(parse_instrument_readings(block("csv", 0), "csv", table, *study.setups[0].device).count(), 2U);
  const Study steps = parse_study(begin + block("toml", 0) + block("toml", 1) + plan, "s", table);
  EXPECT_EQ(steps.setups.at(0).plans.at(0).targets.size(), 6U);
}

TEST(StudyPolygon, SaysWhatIsWrong) {
  const auto says = [](const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  says(message_of_polygon_with("rotary_axis = \"C\"", "rotary_axis = \"X\""),
       "setup[1].rotary_axis: the machine has no rotary axis X; expected one of C");
  says(message_of_polygon_with("faces = 12", "faces = 10"), "setup[1].prism.faces: is not divisible by four");
  says(message_of_polygon_with("distance_mm = 48.3", "distance_mm = 0"), "is not above zero");
  says(message_of_polygon_with("distance_mm = 48.3", "distance_deg = 48.3"), "distance_mm");
  says(message_of_polygon_with("number = 3", "number = 13"), "setup[1].prism.face[1].number");
  says(message_of_polygon_with("[[setup.mount]]\nname = \"first\"",
                               "[[setup.prism.face]]\nnumber = 3\n[[setup.mount]]\nname = \"first\""),
       "face 3 is stated twice");
  says(message_of_polygon_with("name = \"second\"", "name = \"first\""), "two items are called");
  says(message_of_polygon_with("turned_by_faces = 1", "turned_by_faces = 12"), "turned_by_faces");
  says(message_of_polygon_with("centre_mm = [0, 0, 20]", "centre_mm = [15, 0, 20]"), "15 mm beside the line of C");
  says(message_of_polygon_with("centre_mm = [0, 0, 20]", "top = [0, 1, 1]"),
       "the top looks 45 deg aside of the line of C");
  says(message_of_polygon_with("centre_mm = [0, 0, 20]", "sensors_on = \"workpiece\""), "on the same body");
  says(message_of_polygon_with("displacement_um = 0.03", "displacement_um = 0"),
       "noise.displacement_um: is not above zero");
  says(message_of_polygon_with("position_mm = [20, 0, 90]", "position_mm = [60, 0, 90]"),
       "displacement sensor along z");
  says(message_of_polygon_with("zero = {", "measured = [\"displacement_w\"]\nzero = {"),
       "unknown reading \"displacement_w\"");
  says(message_of_polygon_with("zero = { displacement_x_um = 3, autocollimator_y_about_x_arcsec = 2 }",
                               "measured = [\"displacement_x\", \"autocollimator_x_about_z\", \"displacement_x\"]"),
       "measured twice");
  says(message_of_polygon_with("displacement_x_um = 3", "displacement_q_um = 3"), "displacement_q_um");
  std::string text = stepwise();
  text.replace(text.find("displacement = \"z\""), 18, "# only that");
  says(message_of([&] { parsed_polygon_study(text); }), "setup[1].step[3]: measures other kinds of readings");
}

}  // namespace
}  // namespace abbe
