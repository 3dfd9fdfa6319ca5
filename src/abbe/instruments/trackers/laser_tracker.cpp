#include "abbe/instruments/trackers/laser_tracker.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "abbe/geometry/rotation.h"
#include "abbe/instruments/equation_instrument_inline.h"
#include "abbe/instruments/instrument_simulation.h"
#include "abbe/instruments/trackers/tracker_observations.h"
#include "abbe/instruments/trackers/tracker_offset_start.h"
#include "abbe/instruments/trackers/tracker_residual.h"
#include "abbe/instruments/trackers/tracker_simulation.h"
#include "abbe/instruments/trackers/tracker_start.h"
#include "abbe/instruments/trackers/tracker_whitening.h"
#include "abbe/instruments/trackers/turned_vector.h"

namespace abbe {
namespace {

using Eigen::Vector3d;

std::string growing(double at_zero, double per_metre) {
  if (per_metre == 0) return fmt::format("{:.3g} um", at_zero);
  if (at_zero == 0) return fmt::format("{:.3g} um/m", per_metre);
  return fmt::format("{:.3g} um + {:.3g} um/m", at_zero, per_metre);
}

TrackerSetup true_setup(TrackerSetup setup) {
  for (TrackerStation& station : setup.stations) {
    if (station.true_pose) station.body_from_tracker = *station.true_pose;
  }
  for (Reflector& reflector : setup.reflectors) {
    if (reflector.true_offset) reflector.offset = *reflector.true_offset;
  }
  return setup;
}

}  // namespace

LaserTracker::LaserTracker(std::string name, TrackerSetup setup, TrackerMeasure measure, StatedUncertainty stated)
    : EquationInstrument(std::move(name)), given_(std::move(setup)), measure_(measure), stated_(stated) {
  name_components();
  const auto add_number = [this](const std::string& of, bool is_angle, bool estimated, double value, double within) {
    SetupNumber number = estimated ? SetupNumber::open(value) : SetupNumber::exact(value);
    if (estimated && within > 0) number = SetupNumber::within(value, within);
    add(quantity(of, is_angle, number));
  };
  for (const TrackerStation& station : given_.stations) {
    for (int k = 0; k < 3; ++k) {
      add_number(station.name + "." + "xyz"[k], false, station.estimate_pose, station.body_from_tracker.translation[k],
                 0);
    }
    for (int k = 0; k < 3; ++k) add_number(station.name + ".r" + "xyz"[k], true, station.estimate_pose, 0, 0);
  }
  for (const Reflector& reflector : given_.reflectors) {
    for (int k = 0; k < 3; ++k) {
      add_number(reflector.name + ".offset_" + "xyz"[k], false, reflector.estimate_offset, reflector.offset[k],
                 reflector.offset_standard_uncertainty[k]);
    }
  }
  for (std::size_t s = 0; s < given_.stations.size(); ++s) {
    for (std::size_t r = 0; r < given_.reflectors.size(); ++r) {
      const std::string& station = given_.stations[s].name;
      const std::string& reflector = given_.reflectors[r].name;
      InstrumentItem item{given_.stations.size() > 1 ? reflector + " from " + station : reflector,
                          given_.reflectors[r].body,
                          given_.stations[s].body,
                          {}};
      for (std::size_t k = 0; k < 6; ++k) item.quantities.push_back(6 * s + k);
      for (std::size_t k = 0; k < 3; ++k) item.quantities.push_back(reflector_quantity(r) + k);
      add(std::move(item));
    }
  }
}

void LaserTracker::name_components() {
  if (measure_ == TrackerMeasure::cartesian) {
    components_ = {{"x", false}, {"y", false}, {"z", false}};
  } else {
    components_ = {{"range", false}, {"azimuth", true}, {"elevation", true}};
  }
}

std::shared_ptr<const Instrument> LaserTracker::in_coordinates() const {
  auto copy = std::make_shared<LaserTracker>(*this);
  copy->measure_ = TrackerMeasure::cartesian;
  copy->name_components();
  return copy;
}

TrackerSetup LaserTracker::with_given_rotations() const {
  TrackerSetup present = given_;
  const auto point = [this](std::size_t q) -> Vector3d {
    return {quantities_[q].value, quantities_[q + 1].value, quantities_[q + 2].value};
  };
  for (std::size_t s = 0; s < present.stations.size(); ++s) {
    present.stations[s].body_from_tracker.translation = point(6 * s + kStation);
  }
  for (std::size_t r = 0; r < present.reflectors.size(); ++r) {
    present.reflectors[r].offset = point(reflector_quantity(r));
  }
  return present;
}

TrackerSetup LaserTracker::setup() const {
  TrackerSetup present = with_given_rotations();
  for (std::size_t s = 0; s < present.stations.size(); ++s) {
    const std::size_t q = 6 * s + kTurn;
    const Vector3d turn(quantities_[q].value, quantities_[q + 1].value, quantities_[q + 2].value);
    present.stations[s].body_from_tracker.rotation =
        rotation_from_vector(turn) * given_.stations[s].body_from_tracker.rotation;
  }
  return present;
}

TrackerReadings LaserTracker::tracker_readings(const InstrumentReadings& readings) const {
  TrackerReadings result;
  result.measure = measure_;
  result.poses = readings.poses;
  result.time_s = readings.time_s;
  result.point_name = readings.point_name;
  result.drift = readings.drift;
  for (const std::uint16_t item : readings.item) {
    result.station.push_back(static_cast<std::uint16_t>(station_of(item)));
    result.reflector.push_back(static_cast<std::uint16_t>(target_of(item)));
  }
  for (std::size_t c = 0; c < readings.measured.size(); ++c) result.measured[c] = readings.measured[c];
  const auto& stated = readings.covariance.empty() ? readings.uncertainty : readings.covariance;
  for (std::size_t c = 0; c < stated.size(); ++c) result.uncertainty[c] = stated[c];
  result.stated = !readings.covariance.empty()    ? StatedUncertainty::covariance
                  : !readings.uncertainty.empty() ? StatedUncertainty::standard
                                                  : StatedUncertainty::none;
  return result;
}

InstrumentReadings LaserTracker::instrument_readings(const TrackerReadings& readings) const {
  InstrumentReadings result;
  result.poses = readings.poses;
  result.time_s = readings.time_s;
  result.point_name = readings.point_name;
  result.drift = readings.drift;
  for (std::size_t k = 0; k < readings.count(); ++k) {
    result.item.push_back(static_cast<std::uint16_t>(item_of(readings.station[k], readings.reflector[k])));
  }
  result.measured.assign(readings.measured.begin(), readings.measured.end());
  const auto& stated = readings.uncertainty;
  if (readings.stated == StatedUncertainty::standard) result.uncertainty.assign(stated.begin(), stated.begin() + 3);
  if (readings.stated == StatedUncertainty::covariance) result.covariance.assign(stated.begin(), stated.end());
  return result;
}

double LaserTracker::standard_uncertainty(const InstrumentReadings& readings, std::size_t reading,
                                          std::size_t component) const {
  const TrackerNoise& noise = given_.stations[station_of(readings.item[reading])].noise;
  const Vector3d measured(readings.measured[0][reading], readings.measured[1][reading], readings.measured[2][reading]);
  const auto c = static_cast<Eigen::Index>(component);
  if (measure_ == TrackerMeasure::cartesian) return std::sqrt(noise.covariance(measured)(c, c));
  const double range = measured[0];
  if (component == 0) return noise.range_uncertainty(range);
  return noise.transverse_uncertainty(range) / (component == 1 ? range * std::cos(measured[2]) : range);
}

StartedInstrument LaserTracker::started(const Machine& machine, const InstrumentReadings& readings) const {
  TrackerSetup present = setup();
  TrackerStart found = find_poses_and_offsets(machine, *this, readings, present);
  StartedInstrument result;
  for (std::size_t s = 0; s < found.stations.size(); ++s) {
    const StationStart& station = found.stations[s];
    if (station.readings == 0) continue;
    StartFit fit{.place = given_.stations[s].name, .readings = {}, .extent_mm = station.extent_mm};
    for (std::size_t k = 0; k < readings.count(); ++k) {
      if (station_of(readings.item[k]) == s) fit.readings.push_back(k);
    }
    fit.found = station.status == BestFitStatus::ok;
    fit.determined = fit.found || station.status == BestFitStatus::no_consensus;
    result.fits.push_back(std::move(fit));
  }
  apply(found, present);
  result.instrument = std::make_shared<LaserTracker>(name_, std::move(present), measure_, stated_);
  result.warnings = std::move(found.messages);
  return result;
}

std::vector<ReadingMistake> LaserTracker::usual_mistakes() const {
  if (measure_ == TrackerMeasure::cartesian) {
    const ReadingMistake mirrored{{"the measured coordinates are in a left-handed frame, or two of them are swapped"},
                                  [](double* reading) { reading[1] = -reading[1]; }};
    return combined_mistakes({length_unit_mistakes({0, 1, 2}, "the measured coordinates"), {mirrored}});
  }
  const ReadingMistake swapped{{"azimuth and elevation are swapped"},
                               [](double* reading) { std::swap(reading[1], reading[2]); }};
  const ReadingMistake clockwise{{"the azimuth counts clockwise"}, [](double* reading) { reading[1] = -reading[1]; }};
  const ReadingMistake zenith{{"the elevation counts from the zenith"},
                              [](double* reading) { reading[2] = std::numbers::pi / 2 - reading[2]; }};
  return combined_mistakes({length_unit_mistakes({0}, "the ranges"),
                            angle_unit_mistakes({1, 2}, "azimuth and elevation"),
                            {swapped},
                            {clockwise},
                            {zenith}});
}

std::shared_ptr<const Instrument> LaserTracker::truth(RandomStream&) const { return as_planned(); }

std::shared_ptr<const Instrument> LaserTracker::as_planned() const {
  return std::make_shared<LaserTracker>(name_, true_setup(setup()), measure_, stated_);
}

std::optional<MissingNumber> LaserTracker::missing_for_plan() const {
  for (const TrackerStation& station : given_.stations) {
    if (station.pose_is_known || station.true_pose) continue;
    return MissingNumber{fmt::format("it is not said where {} will stand", station.name),
                         "pose = { position_mm = [x, y, z], angles_deg = [a, b, c] }, roughly"};
  }
  for (const Reflector& reflector : given_.reflectors) {
    if (reflector.offset_from_data) {
      return MissingNumber{"a plan has no data for the offset of " + reflector.name, "offset_mm"};
    }
  }
  return std::nullopt;
}

std::unique_ptr<Observations> LaserTracker::observations(const Machine& machine, const ErrorSet& errors,
                                                         const InstrumentReadings& readings) const {
  auto result =
      std::make_unique<TrackerObservations>(machine, errors, with_given_rotations(), tracker_readings(readings));
  std::vector<double> values;
  bool is_turned = false;
  for (const SetupQuantity& quantity : quantities_) {
    if (quantity.knowledge == Knowledge::exact) continue;
    values.push_back(quantity.value);
    is_turned = is_turned || (quantity.is_angle && quantity.value != 0);
  }
  if (readings.drift) values.insert(values.end(), readings.drift->values.begin(), readings.drift->values.end());
  if (is_turned) result->set_parameters(errors.parameters(), values);
  return result;
}

std::unique_ptr<Observations> LaserTracker::observations_in_um(const Machine& machine, const ErrorSet& errors,
                                                               InstrumentReadings readings) const {
  LaserTracker even = *this;
  for (TrackerStation& station : even.given_.stations) station.noise = TrackerNoise::isotropic(1, 0);
  readings.uncertainty.clear();
  readings.covariance.clear();
  return even.observations(machine, errors, readings);
}

SimulatedInstrument LaserTracker::simulate(const Machine& machine, const ErrorSet& errors,
                                           const InstrumentReadings& plan,
                                           const InstrumentSimulationOptions& options) const {
  TrackerSimulationOptions own;
  own.measure = measure_;
  own.seed = options.seed;
  own.noise_factor = options.noise_factor;
  own.outlier_fraction = options.outlier_fraction;
  own.outlier_mm = options.outlier_mm;
  own.line_of_sight = options.line_of_sight;
  own.interval_s = options.interval_s;
  own.threads = options.threads;
  own.progress = options.progress;
  const std::size_t each = options.readings_per_pose;
  const std::size_t sights = each > 0 ? std::min(each, plan.count()) : plan.count();
  for (std::size_t k = 0; k < sights; ++k) {
    own.sights.push_back(
        {static_cast<std::uint16_t>(station_of(plan.item[k])), static_cast<std::uint16_t>(target_of(plan.item[k]))});
  }
  PoseList poses = plan.poses;
  own.time_s = plan.time_s;
  if (each > 0) {
    const auto keep_first = [each](auto& values) {
      std::size_t kept = 0;
      for (std::size_t k = 0; k < values.size(); k += each) values[kept++] = values[k];
      values.resize(kept);
    };
    for (auto& values : poses.axis) keep_first(values);
    for (auto& sides : poses.approach) keep_first(sides);
    for (auto& values : poses.state) {
      if (!values.empty()) keep_first(values);
    }
    if (!own.time_s.empty()) keep_first(own.time_s);
  } else {
    own.choice = SightChoice::cycle;
  }
  own.drift = plan.drift;
  const TrackerSetup present = setup();
  SimulatedTracker simulated = simulate_tracker(machine, errors, present, poses, own);
  state_uncertainty(present, stated_, simulated.readings);
  SimulatedInstrument result;
  result.readings = instrument_readings(simulated.readings);
  result.readings.drift = plan.drift;
  result.outliers = std::move(simulated.outliers);
  result.hidden = simulated.hidden;
  return result;
}

std::vector<ItemLabel> LaserTracker::item_labels() const {
  std::vector<ItemLabel> labels = {{"station", station_names(), {}}, {"reflector", target_names(), {}}};
  for (std::size_t item = 0; item < items_.size(); ++item) {
    labels[0].of_item.push_back(static_cast<std::uint16_t>(station_of(item)));
    labels[1].of_item.push_back(static_cast<std::uint16_t>(target_of(item)));
  }
  return labels;
}

std::vector<double> LaserTracker::deviation_arms(const InstrumentReadings& readings) const {
  if (measure_ == TrackerMeasure::cartesian) return {1, 1, 1};
  double range = 0;
  for (const double one : readings.measured[0]) range += one / static_cast<double>(readings.count());
  return {1, range, range};
}

std::string LaserTracker::noise_words() const {
  const TrackerNoise& noise = given_.stations.front().noise;
  const std::string along = growing(noise.range_um, noise.range_um_per_m),
                    across = growing(noise.transverse_um, noise.transverse_um_per_m);
  return along == across ? along + " in every direction"
                         : fmt::format("{} along the beam and {} across it", along, across);
}

std::vector<InstrumentPlace> LaserTracker::places() const {
  const TrackerSetup present = setup();
  std::vector<InstrumentPlace> result;
  for (std::size_t s = 0; s < present.stations.size(); ++s) {
    const TrackerStation& station = present.stations[s];
    if (!station.estimate_pose) continue;
    InstrumentPlace place;
    place.name = station.name;
    place.body = station.body;
    place.position = station.body_from_tracker.translation;
    place.rotation = station.body_from_tracker.rotation;
    for (std::size_t k = 0; k < 6; ++k) place.quantities.push_back(6 * s + k);
    result.push_back(std::move(place));
  }
  return result;
}

Eigen::MatrixXd LaserTracker::place_slopes(std::size_t, const std::vector<std::size_t>& quantities) const {
  Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(6, static_cast<Eigen::Index>(quantities.size()));
  for (std::size_t i = 0; i < quantities.size(); ++i) {
    const std::size_t first = quantities[i] / 6 * 6;
    const auto row = static_cast<Eigen::Index>(quantities[i] - first), column = static_cast<Eigen::Index>(i);
    if (row < kTurn) {
      slopes(row, column) = 1;
    } else {
      const Vector3d turn(quantities_[first + 3].value, quantities_[first + 4].value, quantities_[first + 5].value);
      slopes.col(column).tail<3>() = rotation_vector_axes(turn).col(row - kTurn);
    }
  }
  return slopes;
}

std::vector<std::string> LaserTracker::target_names() const {
  std::vector<std::string> names;
  for (const Reflector& reflector : given_.reflectors) names.push_back(reflector.name);
  return names;
}

std::vector<std::string> LaserTracker::station_names() const {
  std::vector<std::string> names;
  for (const TrackerStation& station : given_.stations) names.push_back(station.name);
  return names;
}

std::size_t LaserTracker::item_at(const Machine&, std::size_t target, std::size_t station,
                                  const std::vector<double>&) const {
  return item_of(station, target);
}

template <typename S>
void LaserTracker::equation(std::size_t item, const SeenBody<S>& seen, const S* quantities, const double*,
                            S* reading) const {
  using std::atan2, std::sqrt;
  using Vector = Eigen::Matrix<S, 3, 1>;
  const auto vector = [quantities](int first) -> Vector {
    return {quantities[first], quantities[first + 1], quantities[first + 2]};
  };
  const Vector sight = turned_back<S>(vector(kTurn), seen.point(vector(kReflector)) - vector(kStation));
  const Eigen::Matrix3d& rotation = given_.stations[station_of(item)].body_from_tracker.rotation;
  const Vector point = rotation.transpose().cast<S>() * sight;
  if (measure_ == TrackerMeasure::cartesian) {
    for (int k = 0; k < 3; ++k) reading[k] = point[k];
    return;
  }
  reading[0] = sqrt(point.dot(point));
  reading[1] = atan2(point[1], point[0]);
  reading[2] = atan2(point[2], S(sqrt(point[0] * point[0] + point[1] * point[1])));
}

template class EquationInstrument<LaserTracker, 9, 3>;

}  // namespace abbe
