#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "abbe/errors/random_stream.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/identify/distributions.h"
#include "abbe/identify/identify.h"
#include "abbe/identify/trust/prediction.h"
#include "abbe/instruments/autocollimator.h"
#include "abbe/instruments/board_marks.h"
#include "abbe/instruments/dial_indicators.h"
#include "abbe/instruments/electronic_level.h"
#include "abbe/instruments/instrument_observations.h"
#include "abbe/instruments/instrument_simulation.h"
#include "abbe/instruments/meeting_for_test.h"
#include "abbe/instruments/r_test.h"
#include "abbe/instruments/touch_probe.h"
#include "abbe/machine/machines_for_test.h"

/// For every contact and angle instrument: readings without noise give the errors back; with noise, readings that took
/// no part in the fit lie where the fit says, as often as it says.
namespace abbe {
namespace {

struct Campaign {
  std::string name;
  Machine machine;
  std::vector<std::string> errors;     ///< names of motions (each Legendre to degree 3) and locations
  std::vector<std::string> estimated;  ///< of parameter_names(), the others are zero
  std::shared_ptr<const Instrument> instrument;
  InstrumentReadings plan;
};

void PrintTo(const Campaign& campaign, std::ostream* out) { *out << campaign.name; }

/// Errors of that structure with random values of those that are to be estimated, the others zero.
ErrorSet true_errors(const Campaign& campaign) {
  const Machine& machine = campaign.machine;
  ErrorSet errors;
  for (const std::string& name : campaign.errors) {
    std::size_t axis = 0;
    Component component = Component::X;
    bool is_location = false;
    if (!parse_error_name(machine, name, axis, component, is_location)) throw std::logic_error(name);
    if (is_location) {
      errors.locations.push_back({axis, component, 0, 0});
    } else {
      Basis basis;
      basis.order = 3;
      basis.from = machine.axes[axis].travel_min;
      basis.to = machine.axes[axis].travel_max;
      errors.motions.push_back({axis, component, basis, std::vector<double>(basis.size(), 0.0), {}});
    }
  }
  const std::vector<std::string> names = parameter_names(machine, errors);
  const std::vector<bool> angles = parameters_are_angles(machine, errors);
  std::vector<double> values(names.size(), 0.0);
  RandomStream random(11);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (std::find(campaign.estimated.begin(), campaign.estimated.end(), names[i]) == campaign.estimated.end()) continue;
    values[i] = random.normal() * (angles[i] ? 40e-6 : 15e-3);
  }
  errors.set_parameters(values);
  return errors;
}

struct CampaignFit {
  Identification result;
  std::vector<double> truth, found;  ///< of the estimated machine parameters
  std::vector<bool> angle;
  std::vector<HeldOutReading> unseen;
};

CampaignFit fit(const Campaign& campaign, double noise_factor, std::uint64_t seed) {
  const ErrorSet truth = true_errors(campaign);
  ErrorSet start = truth;
  start.set_parameters(std::vector<double>(truth.parameter_count(), 0.0));
  InstrumentSimulationOptions simulation;
  simulation.seed = seed;
  simulation.noise_factor = noise_factor;
  InstrumentObservations observations(
      campaign.machine, start, campaign.instrument,
      simulate_instrument(campaign.machine, truth, campaign.instrument, campaign.plan, simulation).readings);

  Problem problem;
  problem.machine = campaign.machine;
  problem.errors = start;
  CampaignFit fit;
  const std::vector<std::string> names = parameter_names(campaign.machine, truth);
  const std::vector<bool> angles = parameters_are_angles(campaign.machine, truth);
  const std::vector<double> true_values = truth.parameters();
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (std::find(campaign.estimated.begin(), campaign.estimated.end(), names[i]) == campaign.estimated.end()) continue;
    problem.machine_parameters.push_back(i);
    fit.truth.push_back(true_values[i]);
    fit.angle.push_back(angles[i]);
  }
  // What is known is known wrongly by its uncertainty, the rest is guessed roughly.
  std::vector<double> setup = observations.unknown_values();
  SelectedObservations selected{borrowed(observations), {}, std::vector<std::uint8_t>(observations.reading_count(), 1)};
  for (std::size_t i = 0; i < setup.size(); ++i) {
    const SetupQuantity& quantity = campaign.instrument->quantities()[observations.quantity_of(i)];
    RandomStream random(seed, 1000 + i);
    if (quantity.knowledge == Knowledge::within) {
      setup[i] += noise_factor * quantity.standard_uncertainty * random.normal();
      problem.priors.push_back({{0, i}, setup[i], quantity.standard_uncertainty});
    } else {
      setup[i] += random.normal() * (quantity.is_angle ? 1e-4 : 2e-3);
    }
    selected.unknowns.push_back(i);
  }
  for (std::size_t k = 3; k < selected.use.size(); k += 4) selected.use[k] = 0;
  problem.observations.push_back(selected);
  observations.set_parameters(start.parameters(), setup);
  fit.result = identify(problem);
  for (std::size_t i = 0; i < fit.truth.size(); ++i) {
    fit.found.push_back(fit.result.estimates.size() == 0 ? 0 : fit.result.estimates[static_cast<Eigen::Index>(i)]);
  }
  fit.unseen = held_out_readings(problem, fit.result);
  return fit;
}

/// Poses in which rotary axes turn at random within `ranges` (deg, by axis name) and the points of every item meet.
struct Turn {
  const char* axis;
  double from, to;
};
void add_meetings(const Machine& machine, const Instrument& instrument, std::size_t item, std::size_t count,
                  const std::vector<Turn>& turns, double apart, const std::vector<std::vector<double>>& inputs,
                  InstrumentReadings& plan) {
  const InstrumentItem& own = instrument.items()[item];
  for (std::uint64_t trial = 0, found = 0; found < count; ++trial) {
    if (trial > 100 * count) throw std::logic_error(instrument.name() + ": the points meet nowhere");
    RandomStream random(3 + item, trial);
    std::vector<double> start(machine.axes.size(), 0.0);
    for (const Turn& turn : turns) {
      start[machine.find_axis(turn.axis)] = random.uniform(turn.from, turn.to) * kDegree;
    }
    Eigen::Vector3d displacement;
    for (double& d : displacement) d = random.uniform(-apart, apart);
    const auto pose = meet(machine, start, own.from, own.to, *instrument.meeting_points(item), displacement);
    if (!pose) continue;
    ++found;
    for (const std::vector<double>& known : inputs) plan.append(*pose, item, known);
  }
}

const std::vector<std::string> kTrunnionLocations = {"EX0C", "EY0C", "EA0C", "EB0C", "EY0A", "EZ0A", "EB0A", "EC0A"};

Campaign r_test(RTestSetup::Tip tip) {
  RTestSetup setup;
  setup.name = "nest";
  setup.nest = SetupPoint::open({90, 10, 60});
  const Eigen::Vector3d directions[] = {{1, 0, -0.7}, {-0.5, 0.87, -0.7}, {-0.5, -0.87, -0.7}};
  for (const Eigen::Vector3d& direction : directions) {
    RTestSetup::Probe probe;
    probe.name = "p" + std::to_string(setup.probes.size() + 1);
    probe.direction = direction;
    probe.tilt_first = probe.tilt_second = SetupNumber::within(0, 1e-3);
    probe.tip = tip;
    probe.tip_radius = 1.5;
    setup.probes.push_back(probe);
  }
  setup.spheres = {{"ball", SetupPoint::exact({0, 0, -150})}};
  setup.noise = 0.3e-3;
  Campaign campaign{tip == RTestSetup::Tip::flat ? "RTestFlat" : "RTestBall",
                    test::trunnion_mill(),
                    kTrunnionLocations,
                    kTrunnionLocations,
                    std::make_shared<RTest>(setup),
                    {}};
  add_meetings(campaign.machine, *campaign.instrument, 0, 60, {{"C", 0, 360}, {"A", -70, 20}}, 0.2, {{}},
               campaign.plan);
  return campaign;
}

Campaign touch_probe(TouchProbeSetup::Measure measure) {
  TouchProbeSetup setup;
  setup.name = "probe";
  setup.measure = measure;
  setup.tip = SetupPoint::exact({0, 0, -150});
  setup.tip_radius = SetupNumber::within(3, 1e-3);
  setup.scale = SetupNumber::within(5e-6, 1e-6);
  setup.spheres = {{"a", SetupPoint::exact({0, 0, 0}), SetupNumber::exact(10)},
                   {"b", SetupPoint::within({170, 0, 0}, 0.3e-3), SetupNumber::exact(10)},
                   {"c", SetupPoint::within({60, 140, 40}, 0.3e-3), SetupNumber::exact(10)}};
  setup.placements = {{"plate", SetupPoint::open({-80, -50, 60}), SetupPoint::open({0.01, -0.01, 0.3})}};
  setup.noise = 0.5e-3;
  Campaign campaign{measure == TouchProbeSetup::Measure::centre ? "TouchProbeCentres" : "TouchProbeTouches",
                    test::trunnion_mill(),
                    kTrunnionLocations,
                    kTrunnionLocations,
                    std::make_shared<TouchProbe>(setup),
                    {}};
  for (const char* name : {"EXX", "EZZ"}) {
    campaign.errors.push_back(name);
    campaign.estimated.push_back(std::string(name) + "[P1]");
  }
  const bool touches = measure == TouchProbeSetup::Measure::touch;
  std::vector<std::vector<double>> inputs = {{}};
  if (touches) inputs = {{0, 0, -1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  for (std::size_t item = 0; item < 3; ++item) {
    add_meetings(campaign.machine, *campaign.instrument, item, touches ? 15 : 25, {{"C", 0, 360}, {"A", -40, 20}}, 0.1,
                 inputs, campaign.plan);
  }
  return campaign;
}

void add_line(const Machine& machine, std::size_t count, InstrumentReadings& plan) {
  std::vector<AxisRange> ranges = full_ranges(machine, 2);
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    if (machine.axes[i].name != "X") ranges[i] = AxisRange::fixed((ranges[i].from + ranges[i].to) / 2);
  }
  const PoseList poses = line_plan(machine, ranges, count);
  for (std::size_t k = 0; k < poses.count(); ++k) plan.append(poses.pose(k), 0);
}

Campaign dials() {
  DialIndicatorsSetup setup;
  setup.name = "carriage";
  DialIndicatorsSetup::Face top;
  top.point = {0, 0, 260};
  top.offset = SetupNumber::open(0.05);
  top.tilt_first = SetupNumber::open(1e-4);
  // Across the travel the slope of the face looks like the zero of the third dial.
  top.tilt_second = SetupNumber::exact(-2e-4);
  setup.faces = {top};
  const auto dial = [](const char* name, double x, double y, SetupNumber zero) {
    return DialIndicatorsSetup::Dial{name, SetupPoint::exact({x, y, -120}), {0, 0, 1}, zero, 0};
  };
  setup.arrangements = {{"three",
                         {dial("z1", -60, -30, SetupNumber::exact(0)), dial("z2", 60, -30, SetupNumber::open(0.02)),
                          dial("z3", 0, 70, SetupNumber::open(-0.01))}}};
  setup.noise = 0.4e-3;
  setup.flatness = 0.3e-3;
  Campaign campaign{"DialsOnACarriage",
                    test::three_axis_mill(),
                    {"EZX", "EAX", "EBX"},
                    {"EZX[P2]", "EZX[P3]", "EAX[P1]", "EAX[P2]", "EAX[P3]", "EBX[P1]", "EBX[P2]", "EBX[P3]"},
                    std::make_shared<DialIndicators>(setup),
                    {}};
  add_line(campaign.machine, 60, campaign.plan);
  return campaign;
}

Campaign level() {
  ElectronicLevelSetup setup;
  setup.axes = {{"along", {1, 0, 0}, SetupNumber::open(30e-6)}, {"across", {0, 1, 0}, SetupNumber::open(-20e-6)}};
  setup.up_tilt_first = SetupNumber::within(10e-6, 50e-6);
  return {"ElectronicLevel",
          test::three_axis_mill(),
          {"EAX", "EBX"},
          {"EAX[P1]", "EAX[P2]", "EAX[P3]", "EBX[P1]", "EBX[P2]", "EBX[P3]"},
          std::make_shared<ElectronicLevel>(setup),
          {}};
}

Campaign autocollimator() {
  AutocollimatorSetup setup;
  setup.mirror_tilt_first = SetupNumber::open(30e-6);
  setup.mirror_tilt_second = SetupNumber::open(-120e-6);
  setup.indication = AutocollimatorSetup::Indication::half_tangent;
  return {"Autocollimator",
          test::three_axis_mill(),
          {"EBX", "ECX"},
          {"EBX[P1]", "EBX[P2]", "EBX[P3]", "ECX[P1]", "ECX[P2]", "ECX[P3]"},
          std::make_shared<Autocollimator>(setup),
          {}};
}

Campaign with_line(Campaign campaign) {
  add_line(campaign.machine, 60, campaign.plan);
  return campaign;
}

Campaign board_marks() {
  Machine machine = test::yin_engraver('U');
  machine.axes[machine.find_axis("Z")].travel_min = -600;
  BoardMarksSetup setup;
  setup.width = true;
  setup.focus = SetupPoint::exact(machine.tool_offset);
  SetupPoint lying = SetupPoint::open({15, -10, 4});
  lying.coordinate[2] = SetupNumber::within(4, 2e-3);
  SetupPoint flat = SetupPoint::within({0, 0, 0}, 1e-4), upright = SetupPoint::open({90 * kDegree, 0, 0});
  flat.coordinate[2] = SetupNumber::open(0.02);
  setup.boards = {{"lying", lying, flat}, {"upright", SetupPoint::open({0, 40, 60}), upright}};
  setup.waist = SetupNumber::open(0.03);
  setup.divergence = SetupNumber::open(0.05);
  setup.position_noise = 2e-3;
  setup.width_noise = 1e-3;
  Campaign campaign{"BoardMarks",
                    machine,
                    {"EX0C1", "EY0C1", "EY0A"},
                    {"EX0C1", "EY0C1", "EY0A", "tool_X", "tool_Y", "tool_Z"},
                    std::make_shared<BoardMarks>(setup),
                    {}};
  add_meetings(machine, *campaign.instrument, 0, 60, {{"C1", -180, 180}, {"A", -25, 25}, {"C2", 0, 360}}, 1, {{}},
               campaign.plan);
  add_meetings(machine, *campaign.instrument, 1, 60, {{"C1", -30, 30}, {"A", 60, 100}, {"C2", -20, 20}}, 1, {{}},
               campaign.plan);
  return campaign;
}

class ContactInstrument : public testing::TestWithParam<Campaign> {};

TEST_P(ContactInstrument, WithoutNoiseGivesTheErrorsBack) {
  const Campaign& campaign = GetParam();
  const CampaignFit found = fit(campaign, 0, 1);
  ASSERT_EQ(found.result.status, IdentifyStatus::converged) << found.result.message;
  EXPECT_TRUE(found.result.gauge.constraints.empty()) << "nothing of this is unseen";
  for (std::size_t i = 0; i < found.truth.size(); ++i) {
    EXPECT_NEAR(found.found[i], found.truth[i], found.angle[i] ? 1e-9 : 1e-6) << campaign.estimated[i];
  }
}

TEST_P(ContactInstrument, UnseenReadingsLieWithinTheirUncertainty) {
  const Campaign& campaign = GetParam();
  const double limit = chi_square_quantile(0.05, static_cast<double>(campaign.instrument->components().size()));
  int inside = 0, count = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const CampaignFit found = fit(campaign, 1, seed);
    ASSERT_EQ(found.result.status, IdentifyStatus::converged) << found.result.message;
    for (const HeldOutReading& reading : found.unseen) {
      ++count;
      if (reading.normalised_square < limit) ++inside;
    }
  }
  const double coverage = static_cast<double>(inside) / count;
  EXPECT_GT(coverage, 0.90) << inside << " of " << count;
  EXPECT_LT(coverage, 0.99) << inside << " of " << count;
  RecordProperty("coverage", std::to_string(coverage));
}

INSTANTIATE_TEST_SUITE_P(All, ContactInstrument,
                         testing::Values(r_test(RTestSetup::Tip::flat), r_test(RTestSetup::Tip::ball),
                                         touch_probe(TouchProbeSetup::Measure::centre),
                                         touch_probe(TouchProbeSetup::Measure::touch), dials(), with_line(level()),
                                         with_line(autocollimator()), board_marks()),
                         [](const testing::TestParamInfo<Campaign>& tested) { return tested.param.name; });

}  // namespace
}  // namespace abbe
