#include <gtest/gtest.h>
#include <cstdio>
#include "chains_for_test.h"

namespace abbe {
namespace {

struct Case {
  std::unique_ptr<TrackerObservations> observations;
  Problem problem;
  // truth: actual machine; nominal: start. Both in the old frame.
  Case(const Machine& truth, const Machine& nominal, const RigidTransform& to, bool pose, bool offsets, std::size_t n, double noise = 0) {
    TrackerSetup setup;
    TrackerStation station;
    station.body_from_tracker.translation = {1500, 200, 700};
    station.noise = TrackerNoise::isotropic(10, 0);
    station.estimate_pose = false;
    setup.stations = {station};
    for (int r = 0; r < 3; ++r) {
      Reflector reflector;
      reflector.name = "r" + std::to_string(r);
      reflector.offset = r == 0 ? Eigen::Vector3d(60, 0, 50) : r == 1 ? Eigen::Vector3d(-30, 50, 70) : Eigen::Vector3d(-20, -60, 110);
      setup.reflectors.push_back(reflector);
    }
    TrackerSimulationOptions options;
    options.noise_factor = noise;
    options.line_of_sight = false;
    const PoseList poses = random_plan(truth, full_ranges(truth, 2), n, 3);
    TrackerReadings readings = simulate_tracker(truth, ErrorSet{}, setup, poses, options).readings;
    setup.stations[0].estimate_pose = pose;
    const Machine machine = test::moved(nominal, to);
    for (Reflector& reflector : setup.reflectors) { reflector.estimate_offset = offsets; reflector.offset = to.rotation * reflector.offset; }
    const ErrorSet errors = test::all_locations(machine);
    observations = std::make_unique<TrackerObservations>(machine, errors, setup, readings);
    problem = estimate_everything(machine, errors, {observations.get()});
  }
};

Machine perturbed(Machine machine, double rel, double angle, std::uint64_t seed) {
  RandomStream random(seed);
  for (Axis& axis : machine.axes) {
    Eigen::Vector3d w;
    for (int i = 0; i < 3; ++i) w[i] = random.uniform(-1, 1) * angle;
    axis.direction = rotation_from_vector(w) * axis.direction;
    for (int i = 0; i < 3; ++i) axis.point[i] += random.uniform(-1, 1) * rel * 1266;
  }
  for (int i = 0; i < 3; ++i) machine.tool_reference[i] += random.uniform(-1, 1) * rel * 1266;
  return machine;
}

void show(const char* what, Case& one) {
  const Identification r = identify(one.problem);
  double worst = 0;
  for (std::size_t k = 0; k < one.observations->reading_count(); ++k) worst = std::max(worst, one.observations->distance(k).norm());
  std::printf("%-28s %-18s p %zd fixed %zu it %zu chi2 %.12g worst %.3g um cond %.3g | grad %.3g step %.3g\n", what, status_text(r.status), r.estimates.size(),
              r.gauge.constraints.size(), r.history.size(), r.statistics.chi_square, 1e3 * worst, r.statistics.observability.condition,
              r.history.empty() ? 0. : r.history.back().gradient, r.history.empty() ? 0. : r.history.back().step);
  if (std::getenv("VERBOSE")) { for (const auto& h : r.history) std::printf("   cost %.6g damp %.2g step %.3g grad %.3g %d %d\n", h.cost, h.damping, h.step, h.gradient, h.accepted, h.chord);
    for (const auto& c : r.gauge.constraints) std::printf("   %s\n", c.words.c_str()); }
}

Machine random_chain(std::uint64_t seed) {
  RandomStream random(seed, 1);
  const std::size_t n = 1 + static_cast<std::size_t>(random.uniform() * 9);
  const std::size_t on_workpiece = static_cast<std::size_t>(random.uniform() * static_cast<double>(n + 1)) / 2;
  Machine machine;
  for (std::size_t i = 0; i < n; ++i) {
    Axis axis;
    const bool rotary = random.uniform() < 0.6;
    axis.kind = rotary ? AxisKind::rotary : AxisKind::linear;
    axis.name = std::string(rotary ? "C" : "Z") + std::to_string(i + 1);
    axis.side = i < on_workpiece ? ChainSide::workpiece : ChainSide::tool;
    axis.primed = axis.side == ChainSide::workpiece;
    const double choice = random.uniform();
    if (choice < 0.7)
      axis.direction = Eigen::Vector3d::Unit(static_cast<int>(random.uniform() * 3)) * (random.uniform() < 0.5 ? -1 : 1);
    else
      axis.direction = Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    for (int k = 0; k < 3; ++k) axis.point[k] = std::round(random.uniform(-5, 5)) * 100;
    axis.travel_min = rotary ? -2 : -300;
    axis.travel_max = rotary ? 2 : 300;
    machine.axes.push_back(axis);
  }
  machine.tool_reference = {100, 50, 900};
  return machine;
}

TEST(BaseFrame, chains) {
  const int from = std::getenv("FROM") ? std::atoi(std::getenv("FROM")) : 1, to = std::getenv("TO") ? std::atoi(std::getenv("TO")) : 20;
  const double rel = std::getenv("REL") ? std::atof(std::getenv("REL")) : 0.05;
  const double noise = std::getenv("NOISE") ? std::atof(std::getenv("NOISE")) : 0;
  for (int seed = from; seed <= to; ++seed) {
    const Machine truth = random_chain(static_cast<std::uint64_t>(seed));
    const Machine nominal = perturbed(truth, rel, rel * 5 * M_PI / 180 / 0.05, static_cast<std::uint64_t>(seed));
    std::printf("seed %d: %s\n", seed, truth.chain().c_str());
    if (std::getenv("GV")) for (const Axis& a : truth.axes) std::printf("  %s d %.4f %.4f %.4f p %.0f %.0f %.0f\n", a.name.c_str(), a.direction[0], a.direction[1], a.direction[2], a.point[0], a.point[1], a.point[2]);
    for (const bool pose : {false, true})
    for (const double turn : {0.0, 0.1, 2.0, 777.0}) {
      RandomStream random(static_cast<std::uint64_t>(seed), 5);
      const Eigen::Vector3d any(random.normal(), random.normal(), random.normal());
      const RigidTransform frame = turn == 777 ? RigidTransform{rotation_from_vector(2 * any), {random.normal()*1000, random.normal()*1000, random.normal()*1000}} :
        RigidTransform{rotation_about(Eigen::Vector3d(0, 0, 1), turn * M_PI / 180), {0, 0, 0}};
      Case one(truth, nominal, frame, pose, true, 30 + 12 * truth.axes.size(), noise);
      show(("  pose " + std::to_string(pose) + " turn " + std::to_string(turn).substr(0, 4)).c_str(), one);
    }
  }
}

TEST(BaseFrame, reproduce) {
  const Machine nominal = test::seven_axis_arm();
  for (const double start : {0.0, 0.01, 0.05})
  for (const bool pose : {false, true}) {
    for (const double turn : {0.0, 0.1, 2.0, 30.0}) {
      Machine truth = nominal;
      truth.axes[6].direction = rotation_about(Eigen::Vector3d(1, 0, 0), 2 * M_PI / 180) * truth.axes[6].direction;
      const RigidTransform to{rotation_about(Eigen::Vector3d(0, 0, 1), turn * M_PI / 180), {0, 0, 0}};
      Case one(truth, perturbed(nominal, start, start * 5 * M_PI / 180 / 0.05, 8), to, pose, false, 60);
      show(("start " + std::to_string(start).substr(0, 4) + " pose " + std::to_string(pose) + " turn " + std::to_string(turn).substr(0, 4)).c_str(), one);
    }
  }
}

}  // namespace
}  // namespace abbe
