#include "abbe/study/tracker_campaign.h"

#include <fmt/format.h>

#include "abbe/formats/input_error.h"
#include "abbe/formats/measurement_file.h"
#include "abbe/formats/planned_poses.h"
#include "abbe/geometry/rotation.h"
#include "abbe/instruments/path_plan.h"
#include "abbe/instruments/tracker_start.h"
#include "abbe/instruments/tracker_whitening.h"

namespace abbe {
namespace {

RigidTransform transform(const StudyPose& pose) { return {rotation_from_error_angles(pose.angles), pose.position}; }

}  // namespace

TrackerSetup tracker_setup(const Setup& setup, bool truth) {
  TrackerSetup result;
  for (const SetupStation& given : setup.stations) {
    TrackerStation station;
    station.name = given.name;
    station.body = setup.mounted_on;
    station.estimate_pose = given.estimate_pose;
    station.noise = setup.noise;
    const std::optional<StudyPose>& pose = truth && given.true_pose ? given.true_pose : given.pose;
    if (pose) station.body_from_tracker = transform(*pose);
    station.elevation_min = given.elevation[0];
    station.elevation_max = given.elevation[1];
    station.range_min = given.range[0];
    station.range_max = given.range[1];
    result.stations.push_back(station);
  }
  for (const SetupReflector& given : setup.reflectors) {
    Reflector reflector;
    reflector.name = given.name;
    reflector.body = given.mounted_on;
    reflector.offset = truth && given.true_offset ? *given.true_offset : given.offset;
    reflector.estimate_offset = given.estimate_offset;
    reflector.view_direction = given.view_direction;
    reflector.view_half_angle = given.view_half_angle;
    result.reflectors.push_back(reflector);
  }
  return result;
}

namespace {

void append_readings(TrackerReadings& all, const TrackerReadings& more) {
  if (all.count() == 0) {
    all = more;
    return;
  }
  const auto join = [](auto& a, const auto& b) { a.insert(a.end(), b.begin(), b.end()); };
  const double time_offset = all.time_s.empty() ? 0 : all.time_s.back();
  join_labels(all.point_name, all.count(), more.point_name, more.count());
  join_poses(all.poses, more.poses);
  join(all.station, more.station);
  join(all.reflector, more.reflector);
  for (std::size_t i = 0; i < 3; ++i) join(all.measured[i], more.measured[i]);
  for (std::size_t i = 0; i < 6; ++i) join(all.uncertainty[i], more.uncertainty[i]);
  for (double time : more.time_s) all.time_s.push_back(time_offset + time);
}

/// Index of a name among things with names; adds nothing.
template <typename Things>
std::size_t find_name(const Things& things, const std::string& name) {
  for (std::size_t i = 0; i < things.size(); ++i) {
    if (things[i].name == name) return i;
  }
  return things.size();
}

// mm; files state offsets with fewer digits than the study may have.
constexpr double kSameOffset = 1e-3;

/// @param contradictions  in words, where file and study differ; added to
TrackerReadings readings_from_table(const MeasurementTable& table, const Setup& setup, const std::string& file,
                                    TrackerSetup& tracker, std::vector<std::string>& contradictions) {
  std::vector<std::uint16_t> station_index, reflector_index;
  for (const std::string& name : table.stations) {
    std::size_t index = name.empty() && tracker.stations.size() == 1 ? 0 : find_name(tracker.stations, name);
    if (index == tracker.stations.size()) {
      throw InputError({.file = file, .field = "station"}, fmt::format("station '{}' is not in the study", name),
                       "a station of set-up '" + setup.name + "'");
    }
    station_index.push_back(static_cast<std::uint16_t>(index));
  }
  for (std::size_t i = 0; i < table.reflectors.size(); ++i) {
    const std::string& name = table.reflectors[i];
    std::size_t index = name.empty() && tracker.reflectors.size() == 1 ? 0 : find_name(tracker.reflectors, name);
    const bool has_offset = !table.reflector_offset.empty();
    if (index == tracker.reflectors.size()) {
      if (!has_offset) {
        throw InputError({.file = file, .field = "reflector"}, fmt::format("reflector '{}' is not in the study", name),
                         "a reflector of set-up '" + setup.name + "', or offset columns in the file");
      }
      Reflector reflector;
      reflector.name = name;
      reflector.body = setup.mounted_on == Body::tool ? Body::workpiece : Body::tool;
      tracker.reflectors.push_back(reflector);
    }
    const bool from_data = index >= setup.reflectors.size() || setup.reflectors[index].offset_from_data;
    Reflector& reflector = tracker.reflectors[index];
    if (has_offset && from_data) reflector.offset = table.reflector_offset[i];
    if (has_offset && !from_data && !reflector.estimate_offset &&
        (table.reflector_offset[i] - reflector.offset).norm() > kSameOffset) {
      contradictions.push_back(fmt::format(
          "the offset of reflector {} is ({}) mm in {} and ({}) mm in the study, which counts (offset = \"from-data\": "
          "that of the file)",
          reflector.name, fmt::join(table.reflector_offset[i], ", "), file, fmt::join(reflector.offset, ", ")));
    }
    reflector_index.push_back(static_cast<std::uint16_t>(index));
  }

  TrackerReadings readings = table.readings;
  if (!setup.noise_from_data) {
    readings.stated = StatedUncertainty::none;
    readings.uncertainty = {};
  } else if (readings.stated == StatedUncertainty::none) {
    throw InputError({.file = file}, "the study takes the noise from the data, but the file states no uncertainties",
                     readings.measure == TrackerMeasure::cartesian
                         ? "columns u_x_um, u_y_um, u_z_um or cov_xx_um2, ..."
                         : "columns u_range_um, u_azimuth_arcsec, u_elevation_arcsec or cov_range_range_um2, ...");
  }
  for (std::uint16_t& station : readings.station) station = station_index[station];
  for (std::uint16_t& reflector : readings.reflector) reflector = reflector_index[reflector];
  return readings;
}

/// Poses of a file, with one sight for each of them in their order.
PoseList planned_sights(const Machine& machine, const Setup& setup, const MeasurementPlan& plan,
                        TrackerSimulationOptions& options) {
  const PlannedPoses planned = read_planned_poses(plan.file, machine, setup);
  PoseList poses;
  for (std::size_t k = 0; k < planned.poses.count(); ++k) {
    for (const std::size_t reflector : planned.target.empty() ? plan.targets : std::vector{planned.target[k]}) {
      poses.append(planned.poses.pose(k));
      options.sights.push_back({static_cast<std::uint16_t>(planned.station[k]), static_cast<std::uint16_t>(reflector)});
    }
  }
  options.choice = SightChoice::cycle;
  const std::vector<Sight> once = options.sights;
  for (std::size_t r = 1; r < plan.repeats; ++r) {
    if (plan.there_and_back && r % 2 == 1) {
      options.sights.insert(options.sights.end(), once.rbegin(), once.rend());
    } else {
      options.sights.insert(options.sights.end(), once.begin(), once.end());
    }
  }
  return repeated(poses, plan.repeats, plan.there_and_back);
}

void simulate_setup(const Study& study, std::size_t setup_index, const ErrorSet& truth, TrackerCampaign& result,
                    const ProgressCallback& progress) {
  const Setup& setup = study.setups[setup_index];
  for (std::size_t p = 0; p < setup.plans.size(); ++p) {
    const MeasurementPlan& plan = setup.plans[p];
    const std::uint64_t seed = plan_seed(study, setup_index, p);
    TrackerSimulationOptions options;
    options.measure = setup.measure;
    options.seed = seed;
    options.noise_factor = study.simulation->noise ? 1 : 0;
    options.outlier_fraction = study.simulation->outliers.fraction;
    options.outlier_mm = study.simulation->outliers.size;
    options.threads = study.threads;
    options.progress = progress;
    PoseList poses = plan.kind == PlanKind::poses ? planned_sights(study.machine, setup, plan, options)
                                                  : plan_poses(study.machine, plan, seed);
    if (options.sights.empty()) {
      for (std::size_t reflector : plan.targets) {
        options.sights.push_back({static_cast<std::uint16_t>(plan.station), static_cast<std::uint16_t>(reflector)});
      }
    }
    if (approach_matters(study, truth)) poses.approach = approach_in_order(poses);
    SimulatedTracker simulated = simulate_tracker(study.machine, truth, result.truth, poses, options);
    state_uncertainty(result.truth, setup.stated, simulated.readings);
    const std::uint32_t offset = static_cast<std::uint32_t>(result.readings.count());
    append_readings(result.readings, simulated.readings);
    options.noise_factor = 0;
    options.outlier_fraction = 0;
    options.progress = nullptr;
    TrackerReadings exact = simulate_tracker(study.machine, truth, result.truth, poses, options).readings;
    state_uncertainty(result.truth, setup.stated, exact);
    append_readings(result.exact, exact);
    for (std::uint32_t outlier : simulated.outliers) result.outliers.push_back(offset + outlier);
    result.hidden += simulated.hidden;
  }
}

void read_setup(const Study& study, const Setup& setup, TrackerCampaign& result) {
  for (const SetupData& data : setup.data) {
    MeasurementOptions options;
    options.mapping = data.mapping;
    options.threads = study.threads;
    const MeasurementTable table = read_measurements(data.file, study.machine, options);
    const TrackerReadings readings =
        readings_from_table(table, setup, data.file.string(), result.start, result.contradictions);
    if (result.readings.count() > 0 &&
        (readings.measure != result.readings.measure || readings.stated != result.readings.stated)) {
      throw InputError({.file = data.file.string()}, "the files of one set-up differ in their columns",
                       "the same kind of reading and of uncertainty in all files of a set-up");
    }
    append_readings(result.readings, readings);
  }
}

}  // namespace

std::string TrackerCampaign::readings_text(const Machine& machine) const {
  MeasurementTable table;
  table.readings = readings;
  for (const TrackerStation& station : start.stations) table.stations.push_back(station.name);
  for (const Reflector& reflector : start.reflectors) {
    table.reflectors.push_back(reflector.name);
    table.reflector_offset.push_back(reflector.offset);
  }
  return measurements_text(machine, table);
}

ReadingFacts TrackerCampaign::facts() const {
  ReadingFacts facts;
  facts.setup = name;
  facts.time_s = readings.time_s;
  facts.labels = {{"station", {}, readings.station}, {"reflector", {}, readings.reflector}};
  for (const TrackerStation& station : start.stations) facts.labels[0].names.push_back(station.name);
  for (const Reflector& reflector : start.reflectors) facts.labels[1].names.push_back(reflector.name);
  facts.measured.assign(readings.measured.begin(), readings.measured.end());
  facts.arm = {1, 1, 1};
  if (readings.measure == TrackerMeasure::range_and_angles) {
    double range = 0;
    for (const double one : readings.measured[0]) range += one / static_cast<double>(readings.count());
    facts.arm = {1, range, range};
  }
  return facts;
}

void TrackerCampaign::find_start(const Machine& machine, std::vector<std::string>& warnings,
                                 std::vector<std::string>&) {
  for (const std::string& message : contradictions) warnings.push_back(name + ": " + message);
  const TrackerStart found = find_station_poses(machine, ErrorSet{}, start, readings);
  apply(found, start);
  for (const std::string& message : found.messages) warnings.push_back(name + ": " + message);
}

std::unique_ptr<Observations> TrackerCampaign::observations(const Machine& machine, const ErrorSet& errors) const {
  return std::make_unique<TrackerObservations>(machine, errors, start, readings);
}

std::unique_ptr<Observations> TrackerCampaign::exact_observations(const Machine& machine,
                                                                  const ErrorSet& errors) const {
  return std::make_unique<TrackerObservations>(machine, errors, start, exact);
}

std::vector<KnownUnknown> TrackerCampaign::known_offsets(const TrackerSetup& from) const {
  // The unknowns are ordered: poses of the estimated stations, then offsets of the estimated reflectors.
  std::size_t unknown = 0;
  for (const TrackerStation& station : start.stations) unknown += station.estimate_pose ? 6U : 0U;
  std::vector<KnownUnknown> known;
  for (std::size_t r = 0; r < start.reflectors.size(); ++r) {
    if (!start.reflectors[r].estimate_offset) continue;
    for (int k = 0; k < 3; ++k, ++unknown) {
      const double uncertainty = r < offset_uncertainty.size() ? offset_uncertainty[r][k] : 0.0;
      if (uncertainty > 0) known.push_back({unknown, from.reflectors[r].offset[k], uncertainty});
    }
  }
  return known;
}

std::vector<KnownUnknown> TrackerCampaign::known_unknowns() const { return known_offsets(start); }
std::vector<KnownUnknown> TrackerCampaign::true_unknowns() const { return known_offsets(truth); }

std::shared_ptr<CampaignSetup> gather_tracker(const Study& study, std::size_t setup, const ErrorSet* truth,
                                              const ProgressCallback& progress) {
  const Setup& given = study.setups[setup];
  auto result = std::make_unique<TrackerCampaign>();
  result->start = tracker_setup(given, false);
  result->truth = tracker_setup(given, true);
  for (const SetupReflector& reflector : given.reflectors) {
    result->offset_uncertainty.push_back(reflector.offset_standard_uncertainty);
  }
  if (truth != nullptr) {
    simulate_setup(study, setup, *truth, *result, progress);
  } else {
    read_setup(study, given, *result);
  }
  return result;
}

TrackerReadings read_held_out(const Study& study, const TrackerCampaign& campaign) {
  const Setup& setup = study.setups.front();
  const std::filesystem::path& file = *study.identification->held_out_file;
  MeasurementOptions options;
  if (!setup.data.empty()) options.mapping = setup.data.front().mapping;
  options.threads = study.threads;
  TrackerSetup tracker = campaign.start;
  std::vector<std::string> contradictions;  // told of the readings that are fitted
  const std::size_t reflectors = tracker.reflectors.size();
  TrackerReadings readings = readings_from_table(read_measurements(file, study.machine, options), setup, file.string(),
                                                 tracker, contradictions);
  if (tracker.reflectors.size() != reflectors) {
    throw InputError({.file = file.string(), .field = "reflector"},
                     fmt::format("reflector '{}' was not measured", tracker.reflectors.back().name),
                     "reflectors of set-up '" + setup.name + "'");
  }
  return readings;
}

}  // namespace abbe
