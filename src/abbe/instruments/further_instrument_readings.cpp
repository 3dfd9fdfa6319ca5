#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "abbe/errors/error_states.h"
#include "abbe/errors/random_stream.h"
#include "abbe/instruments/further_readings.h"
#include "abbe/instruments/instrument_observations.h"
#include "abbe/instruments/instrument_simulation.h"
#include "abbe/instruments/path_plan.h"

namespace abbe {
namespace {

using Eigen::Vector3d;
constexpr std::size_t kMostPoints = 4;
constexpr double kOtherPlace_mm = 100;
constexpr double kLongerBar = 2;
// Levels and autocollimators show no more.
constexpr double kAngleRange = 0.02;  // rad

/// What a trial does differently from what was measured.
struct Change {
  std::vector<bool> axes;           // [axes] takes other positions
  bool other_directions = false;    // of a bar
  double length = 1;                // of a bar, times that measured
  std::vector<std::size_t> places;  // quantities of other values
};

/// One set-up with the trials that can be made of it.
class InstrumentTrials {
 public:
  InstrumentTrials(const Machine& machine, const ErrorSet& errors, const InstrumentObservations& measured)
      : machine_(machine),
        errors_(errors),
        measured_(measured),
        values_(measured.quantity_values()),
        device_(measured.instrument().with_values(values_)),
        freedom_(device_->pose_freedom()),
        ranges_(measured_ranges(machine, measured.readings().poses)) {
    for (const std::vector<double>& values : measured.readings().measured) {
      const auto [low, high] = std::minmax_element(values.begin(), values.end());
      shown_.push_back({*low, *high});
    }
    for (std::vector<double> stated : measured.readings().uncertainty) {
      const auto middle = stated.begin() + static_cast<std::ptrdiff_t>(stated.size() / 2);
      std::nth_element(stated.begin(), middle, stated.end());
      uncertainty_.push_back(*middle);
    }
  }

  void add(std::vector<FurtherReadings>& list) {
    add_positions(list);
    if (freedom_ == PoseFreedom::at_distance) add_bars(list);
    add_places(list);
  }

 private:
  bool follows() const { return freedom_ == PoseFreedom::together || freedom_ == PoseFreedom::at_distance; }
  bool may_move(std::size_t axis) const { return !follows() || machine_.axes[axis].kind == AxisKind::rotary; }
  std::vector<bool> no_axes() const { return std::vector<bool>(ranges_.size(), false); }

  void add_positions(std::vector<FurtherReadings>& list) {
    const std::vector<Axis>& axes = machine_.axes;
    std::vector<bool> all = no_axes();
    for (const bool moved : {true, false})
      for (std::size_t i = 0; i < axes.size(); ++i) {
        if (!may_move(i) || ranges_[i].moved() != moved) continue;
        if (!moved && freedom_ == PoseFreedom::along_line) continue;
        Change change{no_axes(), false, 1, {}};
        change.axes[i] = true;
        all[i] = all[i] || moved;
        add_trial(list,
                  moved ? fmt::format("more positions of {} with {}, not in equal steps,", axes[i].name, name())
                        : fmt::format("moving {} over its travel with {}", axes[i].name, name()),
                  change, device_);
      }
    if (std::count(all.begin(), all.end(), true) > 1)
      add_trial(list, fmt::format("poses at which all axes stand differently, with {},", name()), {all, false, 1, {}},
                device_);
  }

  void add_bars(std::vector<FurtherReadings>& list) {
    std::vector<bool> rotary = no_axes();
    for (std::size_t i = 0; i < ranges_.size(); ++i) rotary[i] = may_move(i) && ranges_[i].moved();
    add_trial(list, fmt::format("{} in other directions", name()), {no_axes(), true, 1, {}}, device_);
    add_trial(list, fmt::format("{} {:.0f} times as long, in other directions,", name(), kLongerBar),
              {no_axes(), true, kLongerBar, {}}, device_);
    if (std::count(rotary.begin(), rotary.end(), true) > 0)
      add_trial(list, fmt::format("{} in other directions while the rotary axes turn", name()), {rotary, true, 1, {}},
                device_);
  }

  /// Balls, spheres, optics, reflectors somewhere else.
  void add_places(std::vector<FurtherReadings>& list) {
    const std::vector<SetupQuantity>& quantities = device_->quantities();
    std::size_t points = 0;
    std::vector<bool> moved = no_axes();
    for (std::size_t i = 0; i < ranges_.size(); ++i) {
      moved[i] = may_move(i) && ranges_[i].moved();
    }
    for (std::size_t q = 0; q + 2 < quantities.size() && points < kMostPoints; ++q) {
      const std::string& first = quantities[q].name;
      if (!first.ends_with(".x") || !quantities[q + 1].name.ends_with(".y") || !quantities[q + 2].name.ends_with(".z"))
        continue;
      ++points;
      const std::string point = first.substr(0, first.size() - 2);
      for (std::size_t k = 0; k < 3; ++k)
        for (const double sign : {1.0, -1.0}) {
          std::vector<double> values = values_;
          values[q + k] += sign * kOtherPlace_mm;
          if (add_trial(list, fmt::format("{} at another place, {:.0f} mm off in {},", point, kOtherPlace_mm, "xyz"[k]),
                        {moved, false, 1, {q, q + 1, q + 2}}, device_->with_values(values)))
            break;
        }
    }
  }

  std::string name() const { return measured_.name(); }

  /// Readings that the change allows; nothing measured yet.
  InstrumentReadings plan(const Change& change, const Instrument& device) const {
    const InstrumentReadings& readings = measured_.readings();
    const Machine& machine = machine_;
    std::vector<std::size_t> bases;  // filled only if places change; otherwise every reading is a base
    for (std::size_t k = 0; k < readings.count() && !change.places.empty(); ++k) {
      const std::vector<std::size_t>& used = device.items()[readings.item[k]].quantities;
      if (std::find(used.begin(), used.end(), change.places.front()) != used.end()) bases.push_back(k);
    }
    const std::size_t possible = change.places.empty() ? readings.count() : bases.size();
    InstrumentReadings result;
    result.poses.axis.resize(machine.axes.size());
    result.inputs.resize(readings.inputs.size());
    for (std::size_t k = 0; k < kTrialReadings && possible > 0; ++k) {
      RandomStream random(23, k);
      const std::size_t drawn =
          std::min(possible - 1, static_cast<std::size_t>(random.uniform() * static_cast<double>(possible)));
      const std::size_t base = change.places.empty() ? drawn : bases[drawn];
      const std::size_t item = readings.item[base];
      const std::vector<double> old_pose = readings.poses.pose(base);
      std::vector<double> pose = old_pose;
      for (std::size_t i = 0; i < pose.size(); ++i) {
        if (!change.axes[i]) continue;
        const TrialRange range = ranges_[i].moved() ? ranges_[i] : whole_travel(machine.axes[i]);
        pose[i] = random.uniform(range.from, range.to);
      }
      const std::optional<MeetingPoints> before = device_->meeting_points(item), points = device.meeting_points(item);
      if (follows() && before && points) {
        const InstrumentItem& ends = device.items()[item];
        Vector3d displacement = nominal_displacement(machine, old_pose, ends.from, ends.to, *before);
        if (change.other_directions) displacement = displacement.norm() * change.length * direction(random);
        const auto reached = meet(machine, pose, ends.from, ends.to, *points, displacement);
        if (!reached || !within_known(*reached)) continue;
        pose = *reached;
      }
      std::vector<double> inputs;
      for (const std::vector<double>& column : readings.inputs) inputs.push_back(column[base]);
      result.append(pose, item, inputs);
    }
    stand_at_references(machine, result.poses);
    return result;
  }

  static Vector3d direction(RandomStream& random) {
    // A bar does not go far below the table.
    const double z = random.uniform(-0.3, 1), turn = random.uniform(0, 2 * std::numbers::pi);
    const double across = std::sqrt(std::max(0.0, 1 - z * z));
    return {across * std::cos(turn), across * std::sin(turn), z};
  }

  /// Error motions have no value outside their range.
  bool within_known(const std::vector<double>& pose) const { return covers_commands(machine_, errors_, pose); }

  /// Those that the instrument can show, with the uncertainty of the readings measured.
  InstrumentReadings readable(const std::shared_ptr<const Instrument>& device,
                              const InstrumentReadings& planned) const {
    InstrumentSimulationOptions options;
    options.noise_factor = 0;
    InstrumentReadings all = simulate_instrument(machine_, errors_, device, planned, options).readings;
    std::vector<std::size_t> kept;
    for (std::size_t k = 0; k < all.count(); ++k) {
      bool shown = true;
      for (std::size_t c = 0; c < all.measured.size(); ++c) {
        const double value = all.measured[c][k];
        shown = shown && std::isfinite(value);
        if (!device->components()[c].is_angle) continue;
        shown = shown && value > shown_[c].from - kAngleRange && value < shown_[c].to + kAngleRange;
      }
      if (shown) kept.push_back(k);
    }
    all = all.subset(kept);
    all.uncertainty.clear();
    for (const double typical : uncertainty_) all.uncertainty.emplace_back(all.count(), typical);
    return all;
  }

  bool add_trial(std::vector<FurtherReadings>& list, std::string words, const Change& change,
                 const std::shared_ptr<const Instrument>& device) const {
    const InstrumentReadings planned = plan(change, *device);
    if (planned.count() < kLeastReadings) return false;
    const InstrumentReadings readings = readable(device, planned);
    if (readings.count() < kLeastReadings) return false;
    const auto trial = std::make_shared<InstrumentObservations>(machine_, errors_, device, readings);
    std::vector<TrialUnknown> unknowns;
    for (std::size_t u = 0; u < trial->unknowns().size(); ++u) {
      const std::size_t q = trial->quantity_of(u);
      const SetupQuantity& quantity = device->quantities()[q];
      const bool moved = std::find(change.places.begin(), change.places.end(), q) != change.places.end();
      // What is set up anew has new zeros and a new alignment; a bar, a nest and a probe keep theirs.
      const bool anew = moved || (!change.places.empty() && !follows() && !is_coordinate(quantity.name));
      unknowns.push_back({anew, anew && quantity.knowledge == Knowledge::within ? quantity.standard_uncertainty : 0.0});
    }
    list.push_back({std::move(words), trial, std::move(unknowns), {}});
    return true;
  }

  static bool is_coordinate(const std::string& quantity) {
    return quantity.ends_with(".x") || quantity.ends_with(".y") || quantity.ends_with(".z");
  }

  const Machine& machine_;
  const ErrorSet& errors_;
  const InstrumentObservations& measured_;
  std::vector<double> values_;
  std::shared_ptr<const Instrument> device_;  // at the present values
  PoseFreedom freedom_;
  std::vector<TrialRange> ranges_;
  std::vector<TrialRange> shown_;    // [components] of the readings measured
  std::vector<double> uncertainty_;  // [components] their median
};

}  // namespace

std::vector<FurtherReadings> InstrumentObservations::further_readings(const Machine& machine,
                                                                      const ErrorSet& errors) const {
  std::vector<FurtherReadings> list;
  if (reading_count() > 0) InstrumentTrials(machine, errors, *this).add(list);
  return list;
}

}  // namespace abbe
