#include "liu/simulation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rotation.h"
#include "shared_file.h"

namespace abbe {
namespace {

constexpr std::uint64_t kStreamsPerRun = 8;
enum LiuStream : std::uint64_t { stream_a = 1, stream_c, stream_clamping };

std::uint64_t stream_of(const LiuCase& how, LiuStream stream) { return kStreamsPerRun * how.run + stream; }

/// The cylinder as it is clamped while a stage is calibrated: a little beside the axis, as in the reference readings.
LiuStandard standard_on(const std::string& stage, double taper) {
  LiuStandard standard;
  standard.taper = taper;
  if (stage == "A") {
    standard.direction = Eigen::Vector3d::UnitX();
    standard.clamped = {rotation_from_error_angles({0, 0.014, 0.021}), {0, 0.11, -0.06}};
  } else {
    standard.clamped = {rotation_from_error_angles({-0.014, 0, 0.021}), {-0.11, 0, -0.07}};
  }
  return standard;
}

LiuPlaces places_of(const Machine& machine, const LiuScan& scan, const ErrorSet& calibrated, const LiuAxisLine& line) {
  const std::vector<double> as_found = liu_indications(machine, calibrated, scan.positions, line);
  const std::vector<double> as_nominal = liu_indications(machine, {}, scan.positions, line);
  const std::vector<double>& z = scan.positions.axis[machine.find_axis("Z")];
  const double zero = machine.tool_reference.z();
  LiuPlaces places;
  for (std::size_t k = 0; k < z.size(); ++k) {
    const std::size_t quarter = k * kLiuQuarters / z.size();
    places.measured[quarter].push_back(zero + z[k] - scan.indication[k]);
    places.nominal[quarter].push_back(zero + z[k] - as_nominal[k]);
    places.found[quarter].push_back(zero + z[k] - as_found[k]);
  }
  return places;
}

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> result(a.size());
  for (std::size_t k = 0; k < a.size(); ++k) result[k] = a[k] - b[k];
  return result;
}

Eigen::Vector4d cylinder_estimates(const Identification& found, const std::string& probe) {
  Eigen::Vector4d values;
  const std::array<Eigen::Index, 4> index = liu_cylinder_parameters(found, probe);
  for (std::size_t i = 0; i < 4; ++i) values[static_cast<Eigen::Index>(i)] = found.estimates[index[i]];
  return values;
}

/// Standard uncertainties of the clamping errors from the covariance of the cylinder's parameters.
LiuClampingErrors clamping_uncertainty(const Identification& found, const std::string& probe) {
  const std::array<Eigen::Index, 4> index = liu_cylinder_parameters(found, probe);
  const Eigen::Vector4d estimates = cylinder_estimates(found, probe);
  Eigen::Matrix4d covariance, derivative;
  constexpr double kStep = 1e-4;  // the functions are nearly straight
  for (Eigen::Index i = 0; i < 4; ++i) {
    Eigen::Vector4d more = estimates, less = estimates;
    more[i] += kStep;
    less[i] -= kStep;
    const LiuClampingErrors high = liu_clamping_errors(liu_line(more, Eigen::Vector3d::UnitY()));
    const LiuClampingErrors low = liu_clamping_errors(liu_line(less, Eigen::Vector3d::UnitY()));
    for (Eigen::Index j = 0; j < 4; ++j) {
      const auto at = static_cast<std::size_t>(j);
      derivative(j, i) = (high[at] - low[at]) / (2 * kStep);
      covariance(i, j) = found.covariance(index[static_cast<std::size_t>(i)], index[at]);
    }
  }
  const Eigen::Matrix4d result = derivative * covariance * derivative.transpose();
  LiuClampingErrors uncertainty{};
  for (std::size_t i = 0; i < 4; ++i) {
    uncertainty[i] = std::sqrt(result(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)));
  }
  return uncertainty;
}

LiuClampingCalibration calibrate_clamping(const Machine& machine, const ErrorSet& calibrated, const LiuScan& scan,
                                          const LiuNoise& noise) {
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  InstrumentObservations observations(machine, calibrated, liu_probe_on(y, noise, "probe"), liu_readings(scan));
  Problem problem = estimate_everything(machine, calibrated, {borrowed(observations)});
  problem.machine_parameters.clear();
  const Identification found = identify(problem);
  LiuClampingCalibration result;
  result.converged = found.status == IdentifyStatus::converged;
  if (!result.converged) return result;
  const LiuAxisLine line = liu_line(cylinder_estimates(found, "probe"), y);
  result.found = liu_clamping_errors(line);
  result.uncertainty = clamping_uncertainty(found, "probe");
  result.places = places_of(machine, scan, calibrated, line);
  result.readings = scan;
  return result;
}

LiuScan scan_clamped_standard(const Machine& machine, const ErrorSet& truth, const LiuClampingErrors& clamping,
                              const LiuCase& how) {
  LiuStandard standard;
  standard.clamped = liu_clamped(clamping);
  standard.taper = how.taper;
  return liu_scan_standard(machine, truth, liu_four_quarters(machine, "C"), standard, how.noise,
                           stream_of(how, stream_clamping));
}

LiuScan scan_stage(const Machine& machine, const std::string& stage, const ErrorSet& truth, const LiuCase& how) {
  return liu_scan_standard(machine, truth, liu_four_quarters(machine, stage), standard_on(stage, how.taper), how.noise,
                           stream_of(how, stage == "A" ? stream_a : stream_c));
}

LiuClampingSpread spread_of(const std::vector<LiuClampingErrors>& found, const LiuClampingErrors& truth) {
  LiuClampingSpread spread;
  spread.campaigns = found.size();
  if (found.size() < 2) return spread;
  const auto n = static_cast<double>(found.size());
  for (std::size_t i = 0; i < 4; ++i) {
    double squares = 0;
    for (const LiuClampingErrors& one : found) spread.mean[i] += (one[i] - truth[i]) / n;
    for (const LiuClampingErrors& one : found) squares += std::pow(one[i] - truth[i] - spread.mean[i], 2);
    spread.deviation[i] = std::sqrt(squares / (n - 1));
  }
  return spread;
}

}  // namespace

double largest_magnitude(const std::vector<double>& values) {
  double largest = 0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

std::vector<double> LiuPlaces::remaining(std::size_t quarter) const {
  return difference(found[quarter], measured[quarter]);
}

std::vector<double> LiuPlaces::nominal_difference(std::size_t quarter) const {
  return difference(nominal[quarter], measured[quarter]);
}

LiuStageCalibration liu_simulate_stage(const Machine& machine, const std::string& stage, const ErrorSet& truth,
                                       const ErrorSet& known, const LiuCase& how) {
  const Eigen::Vector3d direction = standard_on(stage, 0).direction;
  const LiuScan scan = scan_stage(machine, stage, truth, how);
  InstrumentObservations observations(machine, known, liu_probe_on(direction, how.noise, "probe"), liu_readings(scan));
  Problem problem = estimate_everything(machine, known, {borrowed(observations)});
  const std::size_t first = stage == "A" ? 0 : 4;  // in the order of liu_unknowns()
  problem.machine_parameters = {first, first + 1, first + 2, first + 3};
  const Identification found = identify(problem);
  LiuStageCalibration result;
  result.converged = found.status == IdentifyStatus::converged;
  result.errors = found.errors;
  if (!result.converged) return result;
  result.places = places_of(machine, scan, found.errors, liu_line(cylinder_estimates(found, "probe"), direction));
  return result;
}

LiuClampingErrors liu_clamping_errors(const LiuAxisLine& line) {
  // The y axis of Rz(c) Rx(a) is (-sin c cos a, cos c cos a, sin a). Where it crosses the plane y = 0 is the shift.
  const Eigen::Vector3d& d = line.direction;
  const Eigen::Vector3d crossing = line.point - line.point.y() / d.y() * d;
  return {std::asin(d.z()), std::atan2(-d.x(), d.y()), crossing.x(), crossing.z()};
}

RigidTransform liu_clamped(const LiuClampingErrors& errors) {
  return {rotation_from_error_angles({errors[0], 0, errors[1]}), Eigen::Vector3d(errors[2], 0, errors[3])};
}

LiuClampingCalibration liu_simulate_clamping(const Machine& machine, const ErrorSet& truth, const ErrorSet& calibrated,
                                             const LiuClampingErrors& clamping, const LiuCase& how) {
  return calibrate_clamping(machine, calibrated, scan_clamped_standard(machine, truth, clamping, how), how.noise);
}

LiuReferenceClamping liu_reference_clamping(const Machine& machine) {
  const auto path = shared_file("golden/liu/clamp_exact.csv");
  const MappedFile file(path);
  const CsvTable table = read_csv(file.text(), path.string(),
                                  {{"theta", Quantity::angle},
                                   {"x", Quantity::length},
                                   {"y", Quantity::length},
                                   {"z", Quantity::length},
                                   {"h", Quantity::length}});
  LiuScan scan;
  for (std::size_t k = 0; k < table.rows; ++k) {
    std::vector<double> positions(machine.axes.size(), 0.0);
    positions[machine.find_axis("C")] = table.columns[0].numbers[k];
    positions[machine.find_axis("X")] = table.columns[1].numbers[k];
    positions[machine.find_axis("Y")] = table.columns[2].numbers[k];
    positions[machine.find_axis("Z")] = table.columns[3].numbers[k];
    scan.positions.append(positions);
  }
  scan.indication = table.columns[4].numbers;
  const ErrorSet errors = liu_errors(machine, LiuUnit::millimetre);
  const LiuClampingCalibration found = calibrate_clamping(machine, errors, scan, {});
  LiuReferenceClamping result;
  result.converged = found.converged;
  if (!found.converged) return result;
  for (std::size_t quarter = 0; quarter < kLiuQuarters; ++quarter) {
    result.remaining = std::max(result.remaining, largest_magnitude(found.places.remaining(quarter)));
  }
  // The frame of the true axis of C: the location errors of C are 4 to 7, along x and z and about x and z.
  const auto value = [&](std::size_t i) { return errors.locations[i].value; };
  const RigidTransform stage{rotation_from_error_angles({value(6), 0, value(7)}), {value(4), 0, value(5)}};
  const auto& [tilt_x, tilt_z, shift_x, shift_z] = kLiuTable3Clamping;
  const Eigen::Vector3d towards(std::tan(tilt_x * kDegree), 1, std::tan(tilt_z * kDegree));
  const RigidTransform is = liu_clamped(found.found);
  for (const double along : {-12.0, 12.0}) {
    const Eigen::Vector3d at =
        stage * Eigen::Vector3d(Eigen::Vector3d(shift_x, 0, shift_z) + along * towards.normalized());
    const Eigen::Vector3d axis = is.rotation * Eigen::Vector3d::UnitY();
    result.difference = std::max(result.difference, (at - is.translation).cross(axis).norm());
  }
  return result;
}

LiuCampaign liu_campaign(const Machine& machine, const ErrorSet& truth, const LiuClampingErrors& clamping,
                         const LiuCase& how) {
  LiuCampaign campaign;
  campaign.a = liu_simulate_stage(machine, "A", truth, liu_unknowns(machine), how);
  campaign.c = liu_simulate_stage(machine, "C", truth, campaign.a.errors, how);
  campaign.clamping = liu_simulate_clamping(machine, truth, campaign.c.errors, clamping, how);
  return campaign;
}

LiuJointClamping liu_joint_clamping(const Machine& machine, const ErrorSet& truth, const LiuClampingErrors& clamping,
                                    std::uint64_t run) {
  const LiuCase how{"", liu_table_2_noise(), 0, run};
  const ErrorSet start = liu_unknowns(machine);
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY();
  InstrumentObservations on_a(machine, start, liu_probe_on(x, how.noise, "probe_a"),
                              liu_readings(scan_stage(machine, "A", truth, how)));
  InstrumentObservations on_c(machine, start, liu_probe_on(y, how.noise, "probe_c"),
                              liu_readings(scan_stage(machine, "C", truth, how)));
  InstrumentObservations part(machine, start, liu_probe_on(y, how.noise, "probe_w"),
                              liu_readings(scan_clamped_standard(machine, truth, clamping, how)));
  Problem problem = estimate_everything(machine, start, {borrowed(on_a), borrowed(on_c), borrowed(part)});
  problem.machine_parameters = {0, 1, 2, 3, 4, 5, 6, 7};
  const Identification found = identify(problem);
  LiuJointClamping result;
  result.converged = found.status == IdentifyStatus::converged;
  if (!result.converged) return result;
  result.found = liu_clamping_errors(liu_line(cylinder_estimates(found, "probe_w"), y));
  result.uncertainty = clamping_uncertainty(found, "probe_w");
  return result;
}

LiuClampingSpreads liu_clamping_spreads(const Machine& machine, const ErrorSet& truth,
                                        const LiuClampingErrors& clamping, std::size_t campaigns) {
  std::vector<LiuClampingErrors> steps, joint;
  for (std::size_t run = 0; run < campaigns; ++run) {
    const std::uint64_t noise = 100 + run;
    const LiuCampaign campaign = liu_campaign(machine, truth, clamping, {"", liu_table_2_noise(), 0, noise});
    if (campaign.converged()) steps.push_back(campaign.clamping.found);
    const LiuJointClamping together = liu_joint_clamping(machine, truth, clamping, noise);
    if (together.converged) joint.push_back(together.found);
  }
  return {spread_of(steps, clamping), spread_of(joint, clamping)};
}

}  // namespace abbe
