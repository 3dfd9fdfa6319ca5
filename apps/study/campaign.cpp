#include "study/campaign.h"

#include <fmt/format.h>

#include <algorithm>

#include "abbe/errors/random_errors.h"
#include "abbe/formats/errors_file.h"
#include "abbe/formats/input_error.h"
#include "abbe/formats/measurement_file.h"
#include "abbe/geometry/rotation.h"
#include "abbe/instruments/tracker_start.h"

namespace abbe {
namespace {

RigidTransform transform(const StudyPose& pose) { return {rotation_from_error_angles(pose.angles), pose.position}; }

/// Stations and reflectors of a set-up; `truth` chooses the true values of a simulation.
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
    result.stations.push_back(station);
  }
  for (const SetupReflector& given : setup.reflectors) {
    Reflector reflector;
    reflector.name = given.name;
    reflector.body = given.mounted_on;
    reflector.offset = truth && given.true_offset ? *given.true_offset : given.offset;
    reflector.estimate_offset = given.estimate_offset;
    result.reflectors.push_back(reflector);
  }
  return result;
}

PoseList poses_of(const Machine& machine, const MeasurementPlan& plan, std::uint64_t seed) {
  const std::size_t points = static_cast<std::size_t>(std::max(plan.points, 0));
  switch (plan.kind) {
    case PlanKind::grid:
      return grid_plan(machine, plan.axes);
    case PlanKind::line:
      return line_plan(machine, plan.axes, points);
    case PlanKind::random:
      return random_plan(machine, plan.axes, points, seed);
    case PlanKind::spiral:
      break;
  }
  // The two axes of largest range carry the ellipse.
  std::vector<std::size_t> order(plan.axes.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto extent = [&](std::size_t i) {
    const Axis& axis = machine.axes[i];
    const double whole = axis.travel_max - axis.travel_min;
    return whole > 0 ? (plan.axes[i].to - plan.axes[i].from) / whole : plan.axes[i].to - plan.axes[i].from;
  };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return extent(a) > extent(b); });
  return spiral_plan(machine, plan.axes, points, plan.turns, order.at(0), order.at(1));
}

void append(TrackerReadings& all, const TrackerReadings& more) {
  if (all.count() == 0) {
    all = more;
    return;
  }
  const auto join = [](auto& a, const auto& b) { a.insert(a.end(), b.begin(), b.end()); };
  const double time_offset = all.time_s.empty() ? 0 : all.time_s.back();
  for (std::size_t i = 0; i < all.poses.axis.size(); ++i) join(all.poses.axis[i], more.poses.axis[i]);
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

TrackerReadings readings_from_table(const MeasurementTable& table, const Setup& setup, const std::string& file,
                                    TrackerSetup& tracker) {
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
    if (has_offset && from_data) tracker.reflectors[index].offset = table.reflector_offset[i];
    reflector_index.push_back(static_cast<std::uint16_t>(index));
  }

  TrackerReadings readings = table.readings;
  if (!setup.noise_from_data) {
    readings.stated = StatedUncertainty::none;
    readings.uncertainty = {};
  } else if (readings.stated == StatedUncertainty::none) {
    throw InputError({.file = file}, "the study takes the noise from the data, but the file states no uncertainties",
                     "columns u_x_um, u_y_um, u_z_um or cov_xx_um2, ...");
  }
  for (std::uint16_t& station : readings.station) station = station_index[station];
  for (std::uint16_t& reflector : readings.reflector) reflector = reflector_index[reflector];
  return readings;
}

void simulate_setup(const Study& study, const Setup& setup, std::size_t setup_index, const ErrorSet& truth,
                    CampaignSetup& result, const ProgressCallback& progress) {
  for (std::size_t p = 0; p < setup.plans.size(); ++p) {
    const MeasurementPlan& plan = setup.plans[p];
    // Every plan of every set-up has numbers of its own, whatever stands beside it in the study.
    const std::uint64_t seed = study.seed * 1000003 + setup_index * 1009 + p;
    TrackerSimulationOptions options;
    options.measure = setup.measure;
    options.seed = seed;
    options.noise_factor = study.simulation->noise ? 1 : 0;
    options.outlier_fraction = study.simulation->outliers.fraction;
    options.outlier_mm = study.simulation->outliers.size;
    options.threads = study.threads;
    options.progress = progress;
    for (std::size_t reflector : plan.reflectors) {
      options.sights.push_back({static_cast<std::uint16_t>(plan.station), static_cast<std::uint16_t>(reflector)});
    }
    const PoseList poses = poses_of(study.machine, plan, seed);
    const SimulatedTracker simulated = simulate_tracker(study.machine, truth, result.truth, poses, options);
    const std::uint32_t offset = static_cast<std::uint32_t>(result.readings.count());
    append(result.readings, simulated.readings);
    options.noise_factor = 0;
    options.outlier_fraction = 0;
    options.progress = nullptr;
    append(result.exact, simulate_tracker(study.machine, truth, result.truth, poses, options).readings);
    for (std::uint32_t outlier : simulated.outliers) result.outliers.push_back(offset + outlier);
    result.hidden += simulated.hidden;
  }
}

void read_setup(const Study& study, const Setup& setup, CampaignSetup& result) {
  for (const SetupData& data : setup.data) {
    MeasurementOptions options;
    options.mapping = data.mapping;
    options.threads = study.threads;
    const MeasurementTable table = read_measurements(data.file, study.machine, options);
    const TrackerReadings readings = readings_from_table(table, setup, data.file.string(), result.start);
    if (result.readings.count() > 0 &&
        (readings.measure != result.readings.measure || readings.stated != result.readings.stated)) {
      throw InputError({.file = data.file.string()}, "the files of one set-up differ in their columns",
                       "the same kind of reading and of uncertainty in all files of a set-up");
    }
    append(result.readings, readings);
  }
}

}  // namespace

std::size_t Campaign::reading_count() const {
  std::size_t count = 0;
  for (const CampaignSetup& setup : setups) count += setup.readings.count();
  return count;
}

ErrorSet true_errors(const Study& study) {
  const Simulation& simulation = *study.simulation;
  if (simulation.errors_file) return read_errors(*simulation.errors_file, study.machine).errors;
  const ErrorGenerator& generator = *simulation.generator;
  RandomErrorOptions options;
  options.seed = generator.seed;
  options.linear_order = generator.linear_order;
  options.rotary_harmonics = generator.rotary_order;
  options.rotary_order = generator.rotary_order;
  options.locations = generator.location_errors;
  ErrorSet errors = random_errors(study.machine, options);
  VolumetricTarget target;
  target.measure = generator.mean_volumetric ? VolumetricMeasure::mean : VolumetricMeasure::maximum;
  target.value_um = 1e3 * (generator.mean_volumetric ? *generator.mean_volumetric : *generator.maximum_volumetric);
  scale_errors(study.machine, errors, target);
  return errors;
}

Campaign gather_readings(const Study& study, const ProgressCallback& progress) {
  Campaign campaign;
  if (study.simulation) campaign.truth = true_errors(study);
  for (std::size_t i = 0; i < study.setups.size(); ++i) {
    const Setup& setup = study.setups[i];
    CampaignSetup result;
    result.name = setup.name;
    result.start = tracker_setup(setup, false);
    result.truth = tracker_setup(setup, true);
    if (study.simulation) {
      simulate_setup(study, setup, i, *campaign.truth, result, progress);
      if (result.hidden > 0) {
        campaign.notes.push_back(
            fmt::format("{}: {} readings left out for lack of a line of sight", setup.name, result.hidden));
      }
    } else {
      read_setup(study, setup, result);
    }
    if (result.readings.count() == 0) {
      throw InputError({.file = setup.name}, "the set-up has no readings", "at least one reading");
    }
    campaign.setups.push_back(std::move(result));
  }
  return campaign;
}

TrackerReadings read_held_out(const Study& study, const Campaign& campaign) {
  const Setup& setup = study.setups.front();
  const std::filesystem::path& file = *study.identification->held_out_file;
  MeasurementOptions options;
  if (!setup.data.empty()) options.mapping = setup.data.front().mapping;
  options.threads = study.threads;
  TrackerSetup tracker = campaign.setups.front().start;
  const std::size_t reflectors = tracker.reflectors.size();
  TrackerReadings readings =
      readings_from_table(read_measurements(file, study.machine, options), setup, file.string(), tracker);
  if (tracker.reflectors.size() != reflectors) {
    throw InputError({.file = file.string(), .field = "reflector"},
                     fmt::format("reflector '{}' was not measured", tracker.reflectors.back().name),
                     "reflectors of set-up '" + setup.name + "'");
  }
  return readings;
}

void find_start_poses(const Machine& machine, Campaign& campaign) {
  for (CampaignSetup& setup : campaign.setups) {
    const TrackerStart found = find_station_poses(machine, ErrorSet{}, setup.start, setup.readings);
    apply(found, setup.start);
    for (std::size_t s = 0; s < found.stations.size(); ++s) {
      const StationStart& station = found.stations[s];
      if (!station.note.empty()) {
        campaign.warnings.push_back(fmt::format("{}: {}", setup.start.stations[s].name, station.note));
      }
    }
    for (const std::string& message : found.messages) campaign.warnings.push_back(setup.name + ": " + message);
  }
}

}  // namespace abbe
