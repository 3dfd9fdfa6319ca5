#include <gtest/gtest.h>

#include <numbers>

#include "abbe/formats/controls/turntable_machine_for_test.h"
#include "abbe/formats/readings/instrument_file.h"
#include "abbe/formats/study/study_file.h"
#include "abbe/formats/text/message_of.h"
#include "abbe/formats/text/replaced_text_for_test.h"

namespace abbe {
namespace {

std::string study_of(const std::string& setup) {
  return "machine = \"m.machine.toml\"\n[simulate]\n[simulate.generator]\nmean_volumetric_um = 100\n[[setup]]\n"
         "name = \"s\"\n" +
         setup + "[[setup.plan]]\nkind = \"random\"\npoints = 5\naxis.X = {}\n";
}

std::shared_ptr<const Instrument> read(const std::string& setup) {
  return parse_study(study_of(setup), "s.study.toml", test::endless_turntable()).setups.at(0).device;
}

/// Message for the set-up with one part replaced.
std::string message_of_setup_with(const std::string& setup, const std::string& from, const std::string& to) {
  return message_of([&] { read(test::replaced(setup, from, to)); });
}

const SetupQuantity& quantity_of(const Instrument& instrument, const std::string& name) {
  for (const SetupQuantity& quantity : instrument.quantities()) {
    if (quantity.name == name) return quantity;
  }
  throw std::out_of_range(name);
}

#define EXPECT_SAYS(message, part) EXPECT_NE((message).find(part), std::string::npos) << (message)

const std::string kRTest = R"(instrument = "r-test"
nest_mm = [80, 0, 60]
noise = { indication_um = 0.3 }
[[setup.probe]]
name = "p1"
direction = [1, 0, -0.7]
tilt_first_mrad = 1
tilt_first_standard_uncertainty_mrad = 2
[[setup.probe]]
name = "p2"
direction = [0, 1, -0.7]
tip = "ball"
tip_radius_mm = 1.5
[[setup.sphere]]
name = "ball"
centre_mm = [0, 0, -150]
)";

TEST(StudyContactInstruments, ReadAnRTest) {
  const auto device = read(kRTest);
  ASSERT_EQ(device->components().size(), 2U);
  EXPECT_EQ(device->components()[1].name, "p2");
  EXPECT_EQ(device->items().at(0).name, "ball");
  EXPECT_EQ(device->items()[0].to, Body::workpiece);
  EXPECT_EQ(quantity_of(*device, "s.nest.x").knowledge, Knowledge::open);
  EXPECT_EQ(quantity_of(*device, "s.p1.tilt_first").knowledge, Knowledge::within);
  EXPECT_DOUBLE_EQ(quantity_of(*device, "s.p1.tilt_first").standard_uncertainty, 2e-3);
  EXPECT_SAYS(message_of_setup_with(kRTest, "[1, 0, -0.7]", "[0, 0, 0]"), "probe[1].direction: has no length");
  EXPECT_SAYS(message_of_setup_with(kRTest, "\"ball\"", "\"round\""), "unknown word \"round\"");
  EXPECT_SAYS(message_of_setup_with(kRTest, "indication_um = 0.3", "indication_um = -1"), "is not above zero");
  EXPECT_SAYS(message_of_setup_with(kRTest, "nest_mm", "nest_deg"), "nest_mm");
  EXPECT_SAYS(message_of_setup_with(kRTest, "[[setup.sphere]]\nname = \"ball\"\ncentre_mm = [0, 0, -150]\n", ""),
              "there is no sphere");
  EXPECT_SAYS(message_of_setup_with(kRTest, "noise", "nest_on = \"tool\"\nnoise"), "same body");
}

const std::string kSurface = R"(instrument = "surface-probe"
standard = "cylinder"
radius_mm = 10
taper_um_per_m = 5
taper_standard_uncertainty_um_per_m = 2
noise = { indication_um = 0.3, form_um = 0.4 }
[[setup.clamping]]
name = "upright"
point_mm = [0, 0, 60]
direction = [0, 1, 0]
[[setup.clamping]]
name = "turned"
point_mm = [0, 0, 60]
direction = [0, 1, 0]
reversed = true
tilt_first_mrad = 2
)";

TEST(StudyContactInstruments, ReadAProbeOnAStandard) {
  const auto device = read(kSurface);
  ASSERT_EQ(device->items().size(), 2U);
  EXPECT_EQ(device->items()[1].name, "turned");
  EXPECT_EQ(quantity_of(*device, "s.radius").knowledge, Knowledge::exact);
  EXPECT_DOUBLE_EQ(quantity_of(*device, "s.taper").value, 5e-6);
  EXPECT_EQ(quantity_of(*device, "upright.offset_first").knowledge, Knowledge::open);
  EXPECT_EQ(quantity_of(*device, "upright.offset_along").knowledge, Knowledge::exact) << "a cylinder has no end";
  EXPECT_DOUBLE_EQ(quantity_of(*device, "turned.tilt_first").value, 2e-3);
  EXPECT_DOUBLE_EQ(device->standard_uncertainty({}, 0, 0), 0.5e-3);
  EXPECT_SAYS(message_of_setup_with(kSurface, "\"cylinder\"", "\"cone\""), "unknown word \"cone\"");
  EXPECT_SAYS(message_of_setup_with(kSurface, "radius_mm = 10", "radius_mm = -1"), "radius_mm: is not above zero");
  EXPECT_SAYS(message_of_setup_with(kSurface, "taper_um_per_m = 5", "taper_um = 5"), "taper_um");
  EXPECT_SAYS(message_of_setup_with(kSurface, "\"cylinder\"", "\"sphere\""), "direction: unknown key");
  EXPECT_SAYS(message_of_setup_with(kSurface, "noise", "standard_on = \"tool\"\nnoise"), "same body");
  EXPECT_SAYS(message_of_setup_with(kSurface, "\"turned\"", "\"upright\""), "upright");
}

const std::string kProbe = R"(instrument = "touch-probe"
measure = "touch"
tip_mm = [0, 0, -150]
scale_um_per_m = 3
scale_standard_uncertainty_um_per_m = 2
noise = { travel_um = 0.5 }
[[setup.placement]]
name = "flat"
position_mm = [0, 0, 60]
c_deg = 30
[[setup.sphere]]
name = "a"
centre_mm = [80, 0, 0]
radius_mm = 10
)";

TEST(StudyContactInstruments, ReadATouchProbe) {
  const auto device = read(kProbe);
  EXPECT_EQ(device->inputs().size(), 3U);
  EXPECT_EQ(device->planned_inputs(0).size(), 5U);
  EXPECT_EQ(quantity_of(*device, "a.x").knowledge, Knowledge::exact) << "in an artefact";
  EXPECT_DOUBLE_EQ(quantity_of(*device, "s.scale").value, 3e-6);
  EXPECT_NEAR(quantity_of(*device, "flat.c").value, std::numbers::pi / 6, 1e-15);
  EXPECT_SAYS(message_of_setup_with(kProbe, "radius_mm = 10", "radius_mm = 0"), "radius_mm: is not above zero");
  EXPECT_SAYS(message_of_setup_with(kProbe, "travel_um", "centre_um"), "travel");
  EXPECT_SAYS(message_of_setup_with(kProbe, "c_deg", "c_mm"), "c_mm");
  std::string loose = kProbe;
  const std::size_t from = loose.find("[[setup.placement]]");
  loose.erase(from, loose.find("[[setup.sphere]]") - from);
  EXPECT_EQ(quantity_of(*read(loose), "a.x").knowledge, Knowledge::open);
}

const std::string kDials = R"(instrument = "dials"
noise = { indication_um = 0.4, flatness_um = 0.3 }
[[setup.face]]
name = "top"
point_mm = [0, 0, 60]
normal = [0, 0, 1]
[[setup.dial]]
name = "z1"
position_mm = [0, 0, -150]
direction = [0, 0, 1]
face = "top"
)";

TEST(StudyContactInstruments, ReadDials) {
  const auto device = read(kDials);
  EXPECT_EQ(device->components().at(0).name, "z1");
  EXPECT_EQ(quantity_of(*device, "top.tilt_first").knowledge, Knowledge::open);
  EXPECT_NEAR(device->standard_uncertainty({}, 0, 0), 0.5e-3, 1e-15);
  EXPECT_SAYS(message_of_setup_with(kDials, "face = \"top\"", "face = \"side\""),
              "there is no face \"side\"; expected one of top");
  EXPECT_SAYS(message_of_setup_with(kDials, "[0, 0, 1]", "[0, 0, 0]"), "has no length");
  EXPECT_SAYS(message_of_setup_with(kDials, "flatness_um = 0.3", "flatness_um = -0.3"), "flatness_um");
  std::string two = kDials;
  two.replace(two.find("[[setup.dial]]"), 14, "[[setup.arrangement]]\nname = \"up\"\n[[setup.arrangement.dial]]");
  EXPECT_EQ(read(two)->items().at(0).name, "up");
  EXPECT_SAYS(message_of([&] { read(two + "[[setup.arrangement]]\nname = \"none\"\n"); }), "there are no dials");
}

const std::string kLevel = R"(instrument = "level"
relative = true
noise = { inclination_urad = 1 }
[[setup.sensitive]]
name = "along_x"
direction = [1, 0, 0]
)";

TEST(StudyContactInstruments, ReadALevel) {
  const auto device = read(kLevel);
  EXPECT_TRUE(device->components().at(0).is_angle);
  EXPECT_EQ(quantity_of(*device, "s.along_x.zero").knowledge, Knowledge::open);
  EXPECT_EQ(quantity_of(*device, "s.up_tilt_first").knowledge, Knowledge::exact);
  EXPECT_SAYS(message_of_setup_with(kLevel, "[1, 0, 0]", "[0, 0, 1]"), "is vertical");
  EXPECT_SAYS(message_of_setup_with(kLevel, "relative = true", "reference_on = \"tool\""), "relative = true");
  EXPECT_SAYS(message_of_setup_with(kLevel, "inclination_urad", "inclination_um"), "inclination");
}

const std::string kCollimator = R"(instrument = "autocollimator"
beam = [1, 0, 0]
first = [0, 1, 0]
indication = "half-tangent"
noise = { angle_arcsec = 0.1 }
)";

TEST(StudyContactInstruments, ReadAnAutocollimator) {
  const auto device = read(kCollimator);
  EXPECT_EQ(device->components().size(), 2U);
  EXPECT_EQ(quantity_of(*device, "s.mirror_tilt_first").knowledge, Knowledge::open);
  EXPECT_EQ(quantity_of(*device, "s.zero_first").knowledge, Knowledge::exact);
  EXPECT_SAYS(message_of_setup_with(kCollimator, "[0, 1, 0]", "[2, 0, 0]"), "lies along the beam");
  EXPECT_SAYS(message_of_setup_with(kCollimator, "half-tangent", "tangent"), "unknown word \"tangent\"");
}

const std::string kMarks = R"(instrument = "board-marks"
measure = "lines-and-widths"
focus_mm = [0, 0, -240]
waist_um = 30
divergence_mm_per_m = 50
noise = { position_um = 2, width_um = 1 }
[[setup.board]]
name = "lying"
position_mm = [0, 0, 4]
a_deg = 0
a_standard_uncertainty_mrad = 0.1
)";

TEST(StudyContactInstruments, ReadBoardMarks) {
  const auto device = read(kMarks);
  ASSERT_EQ(device->components().size(), 2U);
  EXPECT_EQ(device->inputs().at(0).name, "direction");
  EXPECT_DOUBLE_EQ(quantity_of(*device, "s.divergence").value, 0.05);
  EXPECT_EQ(quantity_of(*device, "lying.a").knowledge, Knowledge::within);
  EXPECT_EQ(quantity_of(*device, "lying.b").knowledge, Knowledge::open);
  EXPECT_DOUBLE_EQ(device->standard_uncertainty({}, 0, 1), 1e-3);
  EXPECT_SAYS(message_of_setup_with(kMarks, "waist_um = 30", "waist_um = 0"), "waist_um: is not above zero");
  EXPECT_SAYS(message_of_setup_with(kMarks, "lines-and-widths", "width"), "unknown word");
  EXPECT_SAYS(message_of_setup_with(kMarks, "width_um = 1", "widht_um = 1"), "width_um");
  EXPECT_EQ(read(kMarks)->planned_inputs(0).size(), 2U);
}

const std::string kPoseTracker = R"(instrument = "pose-tracker"
true_pose = { position_mm = [900, 0, 300], angles_deg = [0, 0, 90] }
noise = { xyz_um = 4, xyz_um_per_m = 3, turn_arcsec = 5 }
[[setup.target]]
name = "frame"
offset_mm = [30, 0, -60]
estimate_offset = true
angles_deg = [0, 0, 180]
true_angles_deg = [0, 1, 180]
)";

TEST(StudyContactInstruments, ReadAPoseTracker) {
  const auto device = read(kPoseTracker);
  ASSERT_EQ(device->components().size(), 6U);
  EXPECT_EQ(quantity_of(*device, "frame.offset_x").knowledge, Knowledge::open);
  EXPECT_EQ(quantity_of(*device, "frame.rz").knowledge, Knowledge::open);
  EXPECT_EQ(quantity_of(*device, "s.ry").knowledge, Knowledge::open);
  EXPECT_SAYS(
      message_of_setup_with(kPoseTracker, "true_pose = { position_mm = [900, 0, 300], angles_deg = [0, 0, 90] }", ""),
      "a simulation needs the true pose");
  EXPECT_SAYS(message_of_setup_with(kPoseTracker, ", turn_arcsec = 5", ""), "turn");
  EXPECT_SAYS(message_of_setup_with(kPoseTracker, "name = \"frame\"", "name = \"frame\"\nmounted_on = \"workpiece\""),
              "the target and the instrument are on the same body");
  EXPECT_SAYS(message_of_setup_with(kPoseTracker, "angles_deg = [0, 0, 180]\n", "estimate_angles = false\n"),
              "angles that are not estimated must be given");
  EXPECT_SAYS(message_of_setup_with(kPoseTracker, "[[setup.target]]", "[[setup.reflector]]"),
              "it is not said what is seen");
}

TEST(StudyContactInstruments, ReadingsOfAllComeBackFromTheirFile) {
  const Machine machine = test::endless_turntable();
  for (const std::string& setup : {kRTest, kProbe, kDials, kLevel, kCollimator, kMarks}) {
    const auto device = read(setup);
    InstrumentReadings plan;
    for (const double x : {1.25, 1.5}) {
      for (const std::vector<double>& inputs : device->planned_inputs(0)) plan.append({0.1, x, 3}, 0, inputs);
    }
    plan.measured.assign(device->components().size(), std::vector<double>(plan.count(), 1.25e-3));
    const InstrumentReadings again =
        parse_instrument_readings(instrument_readings_text(machine, *device, plan), "r.csv", machine, *device);
    ASSERT_EQ(again.count(), plan.count()) << setup;
    for (std::size_t row = 0; row < plan.measured.size(); ++row) {
      for (std::size_t k = 0; k < plan.count(); ++k) {
        EXPECT_NEAR(again.measured[row][k], plan.measured[row][k], 1e-17) << setup;
      }
    }
    for (std::size_t i = 0; i < plan.inputs.size(); ++i) {
      for (std::size_t k = 0; k < plan.count(); ++k) EXPECT_NEAR(again.inputs[i][k], plan.inputs[i][k], 1e-15);
    }
  }
}

}  // namespace
}  // namespace abbe
