#include "abbe/instruments/trackers/tracking_interferometer.h"

#include <cmath>
#include <stdexcept>

#include "abbe/instruments/equation_instrument_inline.h"
#include "abbe/instruments/trackers/tracking_interferometer_start.h"

namespace abbe {

TrackingInterferometer::TrackingInterferometer(const TrackingInterferometerSetup& setup)
    : EquationInstrument(setup.name), setup_(setup) {
  if (setup.runs.empty()) throw std::invalid_argument(setup.name + ": no run");
  components_ = {{"length", false}};
  const std::size_t scale_index = add(pure_number(setup.name + ".length_scale", setup.length_scale));
  std::vector<std::array<std::size_t, 3>> stations, reflectors;
  for (const auto& station : setup.stations) stations.push_back(add(station.name, station.position));
  for (const auto& reflector : setup.reflectors) reflectors.push_back(add(reflector.name, reflector.offset));
  for (const TrackingInterferometerSetup::Run& run : setup.runs) {
    if (run.station >= stations.size()) throw std::invalid_argument(run.name + ": no such station");
    if (run.reflector >= reflectors.size()) throw std::invalid_argument(run.name + ": no such reflector");
    const Body from = setup.reflectors[run.reflector].body, to = setup.stations[run.station].body;
    if (from == to) throw std::invalid_argument(run.name + ": station and reflector are on one body");
    const std::array<std::size_t, 3>& r = reflectors[run.reflector];
    const std::array<std::size_t, 3>& p = stations[run.station];
    const std::size_t dead_path = add(quantity(run.name + ".dead_path", false, run.dead_path));
    add(InstrumentItem{run.name, from, to, {r[0], r[1], r[2], p[0], p[1], p[2], dead_path, scale_index}});
  }
}

double TrackingInterferometer::standard_uncertainty(const InstrumentReadings& readings, std::size_t reading,
                                                    std::size_t) const {
  const std::size_t dead_path = items_[readings.item[reading]].quantities[kDeadPath];
  const double length = readings.measured[0][reading] + quantities_[dead_path].value;
  return setup_.noise + setup_.noise_per_length * std::abs(length);
}

std::vector<double> TrackingInterferometer::start_values(const Machine& machine, const InstrumentReadings& readings,
                                                         std::vector<std::string>& notes) const {
  const TrackingStart start = find_tracking_start(machine, ErrorSet{}, *this, readings);
  notes.insert(notes.end(), start.messages.begin(), start.messages.end());
  return start.values;
}

StartedInstrument TrackingInterferometer::started(const Machine& machine, const InstrumentReadings& readings) const {
  TrackingStart start = find_tracking_start(machine, ErrorSet{}, *this, readings);
  StartedInstrument result;
  for (std::size_t s = 0; s < start.stations.size(); ++s) {
    const TrackingStationStart& station = start.stations[s];
    if (station.status == TrilaterationStatus::not_run) continue;
    StartFit fit{.place = setup_.stations[s].name, .readings = {}, .extent_mm = station.extent_mm};
    for (std::size_t k = 0; k < readings.count(); ++k) {
      const std::size_t run = readings.item[k];
      if (setup_.runs[run].station != s) continue;
      fit.readings.push_back(k);
      fit.rough |= quantities_[items_[run].quantities[kReflector]].knowledge == Knowledge::open;
    }
    fit.found = station.status == TrilaterationStatus::ok || station.status == TrilaterationStatus::mirrored;
    fit.determined = fit.found || station.status == TrilaterationStatus::no_consensus;
    result.fits.push_back(std::move(fit));
  }
  result.instrument = with_values(start.values);
  result.warnings = std::move(start.messages);
  return result;
}

std::vector<ReadingMistake> TrackingInterferometer::usual_mistakes() const {
  const ReadingMistake reversed{{"the lengths grow towards the interferometer"},
                                [](double* reading) { reading[0] = -reading[0]; }};
  std::vector<ReadingMistake> factors = length_unit_mistakes({0}, "the lengths");
  factors.push_back(
      {{"the lengths are those of the optical path, twice as long"}, [](double* reading) { reading[0] /= 2; }});
  factors.push_back({{"the lengths were halved"}, [](double* reading) { reading[0] *= 2; }});
  return combined_mistakes({factors, {reversed}});
}

std::optional<MeetingPoints> TrackingInterferometer::meeting_points(std::size_t item) const {
  const auto at = [&](std::size_t first) -> Eigen::Vector3d {
    const std::vector<std::size_t>& q = items_[item].quantities;
    return {quantities_[q[first]].value, quantities_[q[first + 1]].value, quantities_[q[first + 2]].value};
  };
  return MeetingPoints{at(kReflector), at(kStation)};
}

template <typename S>
void TrackingInterferometer::equation(std::size_t, const SeenBody<S>& seen, const S* quantities, const double*,
                                      S* reading) const {
  using std::sqrt;
  const Eigen::Matrix<S, 3, 1> reflector(quantities[0], quantities[1], quantities[2]);
  const Eigen::Matrix<S, 3, 1> station(quantities[3], quantities[4], quantities[5]);
  const Eigen::Matrix<S, 3, 1> sight = seen.point(reflector) - station;
  reading[0] = (S(1) + quantities[7]) * (sqrt(sight.dot(sight)) - quantities[6]);
}

template class EquationInstrument<TrackingInterferometer, 8, 1>;

}  // namespace abbe
