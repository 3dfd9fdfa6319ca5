#include "abbe/instruments/trackers/tracker_start.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/errors/chain_plan.h"
#include "abbe/errors/error_states.h"
#include "abbe/instruments/instrument.h"

namespace abbe {
namespace {

using Eigen::Vector3d;

/// Where the machine puts a reflector, seen from a body, for chosen readings.
std::vector<Vector3d> seen_points(const Machine& machine, const ErrorSet& errors, Body to, const Reflector& reflector,
                                  const TrackerReadings& readings, const std::vector<std::size_t>& chosen) {
  const std::size_t n = chosen.size();
  std::vector<std::vector<double>> positions(machine.axes.size(), std::vector<double>(n));
  std::vector<const double*> axis;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    for (std::size_t k = 0; k < n; ++k) positions[i][k] = readings.poses.axis[i][chosen[k]];
    axis.push_back(positions[i].data());
  }
  const Vector3d start = reflector_start(reflector, errors);
  std::array<std::vector<double>, 3> p;
  for (std::size_t c = 0; c < 3; ++c) p[c].assign(n, start[static_cast<int>(c)]);
  const ChainPlan plan(machine, errors, reflector.body, to);
  std::vector<double> states;
  std::vector<const double*> state;
  GivenStates(machine, errors).gather(readings.poses, chosen, states, state);
  plan.transform({axis, n, state}, {p[0].data(), p[1].data(), p[2].data()}, {p[0].data(), p[1].data(), p[2].data()});
  std::vector<Vector3d> points(n);
  for (std::size_t k = 0; k < n; ++k) points[k] = {p[0][k], p[1][k], p[2][k]};
  return points;
}

std::string direction_text(const Vector3d& direction) {
  // Rounded first, and no minus before a zero.
  const Vector3d d = (direction * 1e3).array().round().matrix() * 1e-3 + Vector3d::Zero();
  return fmt::format("({:.3f}, {:.3f}, {:.3f})", d.x(), d.y(), d.z());
}

std::string note_of(const BestFitTransform& fit, const TrackerStation& station) {
  switch (fit.status) {
    case BestFitStatus::ok:
    case BestFitStatus::not_run:
      return "";
    case BestFitStatus::too_few_points:
      return station.name + ": fewer than three readings, pose not determined";
    case BestFitStatus::coincident:
      return station.name + ": all readings at one point, rotation not determined";
    case BestFitStatus::collinear:
      return fmt::format("{}: all readings on one line, rotation about direction {} of the {} not determined",
                         station.name, direction_text(fit.undetermined_direction), body_name(station.body));
    case BestFitStatus::no_consensus:
      return station.name + ": no pose explains half of the readings; are stations, reflectors or axes mixed up?";
  }
  return "";
}

/// The extent below which points are called collinear: a rotation then changes nothing that the readings could show.
double collinear_extent(const TrackerReadings& readings, const TrackerStation& station,
                        const std::vector<std::size_t>& chosen, double asked) {
  double range = 0;
  for (std::size_t k : chosen) range += readings.point(k).norm() / static_cast<double>(chosen.size());
  return std::max(asked,
                  3 * std::max(station.noise.range_uncertainty(range), station.noise.transverse_uncertainty(range)));
}

struct Explanation {
  std::size_t reading, stated, better;
  double stated_mm, better_mm;
};

void report_swapped(std::vector<Explanation>& found, const TrackerSetup& setup, TrackerStart& start) {
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.reading < b.reading; });
  for (std::size_t i = 0; i < found.size();) {
    std::size_t end = i;
    SwappedReflector run{.first = found[i].reading, .stated = found[i].stated, .better = found[i].better};
    while (end < found.size() && found[end].reading == found[i].reading + (end - i) &&
           found[end].stated == run.stated && found[end].better == run.better) {
      run.stated_mm += found[end].stated_mm;
      run.better_mm += found[end].better_mm;
      ++end;
    }
    const double count = static_cast<double>(end - i);
    run.last = found[end - 1].reading;
    run.stated_mm /= count;
    run.better_mm /= count;
    const std::string which = run.first == run.last ? fmt::format("reading {}", run.first)
                                                    : fmt::format("readings {}..{}", run.first, run.last);
    start.messages.push_back(fmt::format("{}: {} fits better than {} ({:.3f} mm instead of {:.3f} mm)", which,
                                         setup.reflectors[run.better].name, setup.reflectors[run.stated].name,
                                         run.better_mm, run.stated_mm));
    start.swapped.push_back(run);
    i = end;
  }
}

}  // namespace

bool TrackerStart::determined() const {
  return std::all_of(stations.begin(), stations.end(), [](const StationStart& station) {
    return station.readings == 0 || station.status == BestFitStatus::ok;
  });
}

TrackerStart find_station_poses(const Machine& machine, const ErrorSet& errors, const TrackerSetup& setup,
                                const TrackerReadings& readings, const TrackerStartOptions& options) {
  validate(machine, setup, readings);
  TrackerStart start;
  std::vector<Explanation> swapped;
  for (std::size_t s = 0; s < setup.stations.size(); ++s) {
    const TrackerStation& station = setup.stations[s];
    std::vector<std::size_t> own;
    for (std::size_t k = 0; k < readings.count(); ++k) {
      if (readings.station[k] == s) own.push_back(k);
    }
    StationStart result;
    result.body_from_tracker = station.body_from_tracker;
    result.readings = own.size();
    if (own.empty()) {
      start.stations.push_back(result);
      continue;
    }
    // Every reflector at every reading of the station: the stated one for the fit, all for the search of swapped ones.
    std::vector<std::vector<Vector3d>> seen(setup.reflectors.size());
    for (std::size_t r = 0; r < seen.size(); ++r) {
      if (setup.reflectors[r].body == station.body) continue;
      seen[r] = seen_points(machine, errors, station.body, setup.reflectors[r], readings, own);
    }
    std::vector<Vector3d> measured, modelled;
    for (std::size_t i = 0; i < own.size(); ++i) {
      measured.push_back(readings.point(own[i]));
      modelled.push_back(seen[readings.reflector[own[i]]][i]);
    }
    RobustFitOptions fit_options = options.fit;
    fit_options.collinear_extent = collinear_extent(readings, station, own, fit_options.collinear_extent);
    const BestFitTransform fit = robust_best_fit_transform(measured, modelled, fit_options);
    result.status = fit.status;
    result.rms_mm = fit.rms;
    result.extent_mm = extent_of_points(modelled);
    result.note = note_of(fit, station);
    if (!result.note.empty()) start.messages.push_back(result.note);
    if (fit.status == BestFitStatus::ok || fit.status == BestFitStatus::collinear) {
      result.body_from_tracker = fit.target_from_source;
    }
    result.outliers = static_cast<std::size_t>(std::count(fit.inliers.begin(), fit.inliers.end(), std::uint8_t{0}));
    start.stations.push_back(result);
    if (fit.status != BestFitStatus::ok) continue;

    const double tolerance = options.tolerance_mm > 0 ? options.tolerance_mm : 6 * fit.scale;
    for (std::size_t i = 0; i < own.size(); ++i) {
      const Vector3d at = fit.target_from_source * measured[i];
      const double stated = (at - modelled[i]).norm();
      if (stated <= tolerance) continue;
      std::size_t better = seen.size();
      double least = tolerance;
      for (std::size_t r = 0; r < seen.size(); ++r) {
        if (seen[r].empty() || r == readings.reflector[own[i]]) continue;
        const double distance = (at - seen[r][i]).norm();
        if (distance <= least) {
          least = distance;
          better = r;
        }
      }
      if (better < seen.size()) swapped.push_back({own[i], readings.reflector[own[i]], better, stated, least});
    }
  }
  report_swapped(swapped, setup, start);
  return start;
}

void apply(const TrackerStart& start, TrackerSetup& setup) {
  for (std::size_t s = 0; s < start.stations.size() && s < setup.stations.size(); ++s) {
    const BestFitStatus status = start.stations[s].status;
    const bool found = status == BestFitStatus::ok || status == BestFitStatus::collinear;
    if (found && setup.stations[s].estimate_pose)
      setup.stations[s].body_from_tracker = start.stations[s].body_from_tracker;
  }
}

}  // namespace abbe
