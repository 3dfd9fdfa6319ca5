#include "aguado/study.h"

#include <fstream>
#include <nlohmann/json.hpp>

#include "abbe/formats/readings/measurement_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rotation.h"
#include "abbe/instruments/measurement_plan.h"
#include "abbe/instruments/trackers/tracker_start.h"
#include "abbe/verify/unseen_poses.h"
#include "shared_file.h"

namespace abbe {
namespace {

constexpr std::size_t kAxisC = 0, kAxisX = 1, kAxisZ = 2;  // chain order

Basis basis_of(std::size_t axis, int order) {
  if (axis == kAxisC) return {.kind = BasisKind::fourier, .order = order, .from = 0, .to = kTurn, .period = kTurn};
  return {.kind = BasisKind::legendre, .order = order, .from = 0, .to = axis == kAxisX ? 1400.0 : 600.0};
}

/// Error motions of one axis from rows of six columns.
void add_motions(std::size_t axis, const nlohmann::json& rows, ErrorSet& errors) {
  const int functions = static_cast<int>(rows.size());
  for (int k = 0; k < kComponentCount; ++k) {
    ErrorMotion motion{
        axis, static_cast<Component>(k), basis_of(axis, axis == kAxisC ? (functions - 1) / 2 : functions - 1), {}, {}};
    for (const nlohmann::json& row : rows)
      motion.coefficients.push_back(row.at(static_cast<std::size_t>(k)).get<double>());
    errors.motions.push_back(motion);
  }
}

SampleStatistics lengths(const TrackerObservations& observations) {
  std::vector<double> values(observations.reading_count());
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = observations.distance(k).norm();
  return sample_statistics(values);
}

}  // namespace

Machine aguado_machine() {
  Machine machine;
  machine.name = "XCFZ machine of Aguado et al. (2014)";
  machine.description = "table C' on X', tool on Z; the tracker stands on the table";
  Axis c{.name = "C", .kind = AxisKind::rotary, .side = ChainSide::workpiece, .primed = true};
  c.direction = Eigen::Vector3d::UnitZ();
  c.point = {700, 0, -100};
  c.travel_max = kTurn;
  Axis x{.name = "X", .side = ChainSide::workpiece, .primed = true};
  x.travel_max = 1400;
  Axis z{.name = "Z"};
  z.direction = Eigen::Vector3d::UnitZ();
  z.point = {0, 0, 300};
  z.travel_max = 600;
  machine.axes = {c, x, z};
  machine.tool_reference = {0, 0, 300};
  machine.tool_offset = {0, 0, -150};
  machine.bed_from_workpiece = RigidTransform::translate(c.point);
  return machine;
}

AguadoTruth::Expected AguadoTruth::expected(const std::string& key) const {
  for (const auto& [name, values] : figures) {
    if (name == key) return values;
  }
  return {};
}

AguadoTruth read_aguado_truth() {
  const std::filesystem::path path = shared_file("golden/aguado/truth.json");
  std::ifstream file(path);
  nlohmann::json json;
  try {
    json = nlohmann::json::parse(file);
  } catch (const nlohmann::json::exception& error) {
    throw InputError({.file = path.string()}, error.what(), "the truth of the reference readings");
  }
  AguadoTruth truth;
  add_motions(kAxisC, json.at("C_fourier_rows_1_c1_s1_c2_s2"), truth.errors);
  add_motions(kAxisX, json.at("X_legendre_rows_P0_Pn_cols_dx_dy_dz_EA_EB_EC"), truth.errors);
  add_motions(kAxisZ, json.at("Z_legendre"), truth.errors);
  // The true axis of C stands elsewhere than the nominal one. With the workpiece frame on it, that displacement is
  // exactly a constant of EXC, EYC and EZC.
  const Eigen::Vector3d nominal = aguado_machine().axes[kAxisC].point;
  for (std::size_t k = 0; k < 3; ++k) {
    truth.errors.motions[k].coefficients[0] += json.at("C0").at(k).get<double>() - nominal[static_cast<int>(k)];
  }
  TrackerStation station;
  const std::vector<double> lt = json.at("lt").get<std::vector<double>>();
  station.body_from_tracker = {rotation_from_error_angles({lt[3], lt[4], lt[5]}), {lt[0], lt[1], lt[2]}};
  truth.setup.stations.push_back(station);
  for (const nlohmann::json& offset : json.at("offsets")) {
    Reflector reflector;
    reflector.name = "reflector" + std::to_string(truth.setup.reflectors.size() + 1);
    reflector.offset = {offset.at(0).get<double>(), offset.at(1).get<double>(), offset.at(2).get<double>()};
    truth.setup.reflectors.push_back(reflector);
  }
  for (const auto& [key, value] : json.items()) {
    if (key.rfind("expected_", 0) != 0) continue;
    truth.figures.emplace_back(key.substr(9),
                               AguadoTruth::Expected{value.at("initial_mean_um"), value.at("residual_mean_um"),
                                                     value.at("validation_mean_um"), value.at("validation_max_um")});
  }
  return truth;
}

TrackerReadings read_aguado_readings(const std::string& name) {
  MeasurementOptions options;
  options.mapping.columns = {{"X_mm", "x_mm"},
                             {"Z_mm", "z_mm"},
                             {"C_deg", "c_deg"},
                             {"offset_x_mm", "Tx_mm"},
                             {"offset_y_mm", "Ty_mm"},
                             {"offset_z_mm", "Tz_mm"},
                             {"measured_x_mm", "XLT_x_mm"},
                             {"measured_y_mm", "XLT_y_mm"},
                             {"measured_z_mm", "XLT_z_mm"}};
  const AguadoTruth truth = read_aguado_truth();
  const std::filesystem::path path = shared_file("golden/aguado/aguado_" + name + ".csv");
  MeasurementTable table = read_measurements(path, aguado_machine(), options);
  for (std::uint16_t& reflector : table.readings.reflector) {
    for (std::size_t i = 0; i < truth.setup.reflectors.size(); ++i) {
      if ((truth.setup.reflectors[i].offset - table.reflector_offset[reflector]).norm() < 1e-6) {
        reflector = static_cast<std::uint16_t>(i);
        break;
      }
    }
  }
  for (std::uint16_t& station : table.readings.station) station = 0;
  return table.readings;
}

ErrorSet aguado_model(const AguadoOrders& orders) {
  ErrorSet errors;
  for (std::size_t axis : {kAxisC, kAxisX, kAxisZ}) {
    if (axis == kAxisC ? !orders.rotary : !orders.linear) continue;
    const int order = axis == kAxisC ? orders.c : (axis == kAxisX ? orders.x : orders.z);
    for (int k = 0; k < kComponentCount; ++k) {
      ErrorMotion motion{axis, static_cast<Component>(k), basis_of(axis, order), {}, {}};
      motion.coefficients.assign(motion.basis.size(), 0.0);
      errors.motions.push_back(motion);
    }
  }
  return errors;
}

AguadoFit fit_aguado(const AguadoTruth& truth, const TrackerReadings& readings, const TrackerNoise& noise,
                     const AguadoOrders& orders, Strategy strategy, int threads) {
  const Machine machine = aguado_machine();
  const ErrorSet errors = aguado_model(orders);
  AguadoFit fit;

  TrackerSetup setup = truth.setup;
  setup.stations[0].noise = noise;
  setup.stations[0].estimate_pose = orders.estimate_pose;
  fit.initial = lengths(TrackerObservations(machine, ErrorSet{}, setup, readings));
  if (orders.estimate_pose) {
    // Nothing is known of the pose: it is found from the data.
    setup.stations[0].body_from_tracker = {};
    apply(find_station_poses(machine, ErrorSet{}, setup, readings), setup);
  }
  TrackerObservations observations(machine, errors, setup, readings);
  Problem problem = estimate_everything(machine, errors, {borrowed(observations)});
  const std::vector<std::string> names = parameter_names(machine, errors);
  std::vector<std::size_t> estimated;
  for (std::size_t p : problem.machine_parameters) {
    if (names[p].rfind("tool_", 0) == 0) continue;
    if (!orders.constant_of_c && names[p].find("[mean]") != std::string::npos) continue;
    estimated.push_back(p);
  }
  problem.machine_parameters = estimated;
  IdentifyOptions options;
  options.solver.threads = threads;
  // (15) with the pose of the tracker misfits by 200 um in directions that the readings hardly see: a long valley.
  options.solver.max_iterations = 1000;
  const auto rank_of = [&](const Problem& seen) { return find_null_space(seen, present_values(seen), threads).rank; };
  fit.rank = rank_of(problem);
  std::size_t rank_alone = fit.rank;
  if (orders.estimate_pose) {
    Problem alone = problem;
    alone.observations[0].unknowns.clear();
    rank_alone = rank_of(alone);
  }
  fit.open_alone = estimated.size() - rank_alone;
  fit.identification = identify_in_stages(problem, strategy, options).total;
  fit.residual = lengths(observations);

  fit.setup = observations.setup();
  std::vector<AxisRange> ranges = full_ranges(machine, 2);
  // Offsets that were not measured either: inside and outside the three that were.
  TrackerSetup true_setup = truth.setup, identified_setup = fit.setup;
  const Eigen::Vector3d offsets[] = {{50, 50, -100}, {-50, 50, -200}, {0, -50, -150}};
  for (std::size_t i = 0; i < 3; ++i)
    true_setup.reflectors[i].offset = identified_setup.reflectors[i].offset = offsets[i];
  const PoseList poses = random_plan(machine, ranges, 2000, 4711);
  const std::vector<Sight> sights = {{0, 0}, {0, 1}, {0, 2}};
  const ErrorSet none;
  fit.unseen = compare_predictions(machine, {&truth.errors, &true_setup},
                                   {&fit.identification.errors, &identified_setup}, poses, sights, threads);
  fit.unseen_before =
      compare_predictions(machine, {&truth.errors, &true_setup}, {&none, &true_setup}, poses, sights, threads);
  return fit;
}

std::vector<double> aguado_distances(const AguadoTruth& truth, const ErrorSet& errors, const TrackerSetup& setup,
                                     const PoseList& poses) {
  TrackerSimulationOptions options;
  options.sights = {{0, 0}};
  options.noise_factor = 0;
  const Machine machine = aguado_machine();
  const SimulatedTracker seen = simulate_tracker(machine, truth.errors, truth.setup, poses, options);
  TrackerSetup predicted = setup;
  predicted.stations[0].noise = TrackerNoise::isotropic(1, 0);  // only weights, which distances do not have
  const TrackerObservations observations(machine, errors, predicted, seen.readings);
  std::vector<double> distances(observations.reading_count());
  for (std::size_t k = 0; k < distances.size(); ++k) distances[k] = observations.distance(k).norm();
  return distances;
}

}  // namespace abbe
