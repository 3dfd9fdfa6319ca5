#include "abbe/instruments/interferometer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "abbe/instruments/equation_instrument_inline.h"
#include "abbe/instruments/instrument_observations.h"

namespace abbe {
namespace {

const char* component_name(InterferometerComponent component) {
  switch (component) {
    case InterferometerComponent::length:
      return "length";
    case InterferometerComponent::straightness_y:
      return "straightness_y";
    case InterferometerComponent::straightness_z:
      return "straightness_z";
    case InterferometerComponent::roll:
      return "roll";
    case InterferometerComponent::pitch:
      return "pitch";
    case InterferometerComponent::yaw:
      return "yaw";
  }
  return "";
}

bool is_angle(InterferometerComponent component) {
  return component == InterferometerComponent::roll || component == InterferometerComponent::pitch ||
         component == InterferometerComponent::yaw;
}

/// [x y z]: x along the direction, z in the plane of it and `up`.
Eigen::Matrix3d axes_of(const InterferometerRun& run) {
  const double length = run.direction.norm();
  if (!(length > 0) || !std::isfinite(length)) throw std::invalid_argument(run.name + ": direction without length");
  Eigen::Matrix3d axes;
  axes.col(0) = run.direction / length;
  const Eigen::Vector3d side = run.up.cross(axes.col(0));
  if (!(side.norm() > 1e-6 * run.up.norm())) {
    throw std::invalid_argument(run.name + ": `up` lies along the direction of the beam");
  }
  axes.col(1) = side.normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

Eigen::Matrix3d orientation_in_machine(const Machine& machine, const std::vector<double>& positions, Body body) {
  if (body == Body::bed) return Eigen::Matrix3d::Identity();
  if (body == Body::workpiece) return nominal_bed_from_workpiece(machine, positions).rotation;
  return nominal_bed_from_tool(machine, positions).rotation;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

Eigen::Matrix3d nominal_orientation(const Machine& machine, const std::vector<double>& positions, Body from, Body to) {
  return orientation_in_machine(machine, positions, to).transpose() * orientation_in_machine(machine, positions, from);
}

Interferometer::Interferometer(const InterferometerSetup& setup)
    : EquationInstrument(setup.name),
      measured_(setup.components),
      length_noise_(setup.length_noise),
      length_noise_per_length_(setup.length_noise_per_length),
      straightness_noise_(setup.straightness_noise),
      angle_noise_(setup.angle_noise) {
  if (setup.runs.empty()) throw std::invalid_argument(setup.name + ": no run");
  if (measured_.empty()) throw std::invalid_argument(setup.name + ": nothing is measured");
  for (std::size_t i = 0; i < measured_.size(); ++i) {
    if (std::count(measured_.begin(), measured_.end(), measured_[i]) > 1) {
      throw std::invalid_argument(setup.name + ": " + component_name(measured_[i]) + " is measured twice");
    }
    components_.push_back({component_name(measured_[i]), is_angle(measured_[i])});
  }
  const std::array<std::size_t, 3> scales = {
      add(pure_number(setup.name + ".length_scale", setup.length_scale)),
      add(pure_number(setup.name + ".straightness_scale", setup.straightness_scale)),
      add(pure_number(setup.name + ".angle_scale", setup.angle_scale))};
  std::vector<std::array<std::size_t, 3>> alignments;
  for (std::size_t i = 0; i < setup.runs.size(); ++i) add_run(setup, i, scales, alignments);
}

void Interferometer::add_run(const InterferometerSetup& setup, std::size_t index,
                             const std::array<std::size_t, 3>& scales,
                             std::vector<std::array<std::size_t, 3>>& alignments) {
  const InterferometerRun& run = setup.runs[index];
  Line line;
  line.nominal_axes = line.first_axes = axes_of(run);
  line.square_normal.setZero();
  line.orientation_transpose = run.aligned_orientation.transpose();
  line.target = run.target;
  line.reflector_moves = run.straightness_reflector_moves;
  line.dead_path = run.dead_path;

  const std::array<std::size_t, 3> optic = add(run.name + ".optic", run.optic);
  const std::array<std::size_t, 3> origin = add(run.name + ".origin", run.origin);
  std::array<std::size_t, 3> alignment{};
  if (run.square_with.empty()) {
    const char* names[] = {".roll", ".pitch", ".yaw"};
    for (std::size_t i = 0; i < 3; ++i) alignment[i] = add(quantity(run.name + names[i], true, run.alignment[i]));
  } else {
    std::size_t first = 0;
    while (first < index && setup.runs[first].name != run.square_with) ++first;
    if (first == index) {
      throw std::invalid_argument(run.name + ": no earlier run " + run.square_with + " to be square with");
    }
    const InterferometerRun& other = setup.runs[first];
    if (!other.square_with.empty()) {
      throw std::invalid_argument(run.name + ": " + other.name + " itself goes through the square");
    }
    if (other.reference_body != run.reference_body || other.straightness_reflector_moves ||
        run.straightness_reflector_moves) {
      throw std::invalid_argument(run.name + ": the straightness reflector has to stand on one body for both runs");
    }
    line.first_axes = axes_of(other);
    const Eigen::Vector3d normal = line.first_axes.col(0).cross(line.nominal_axes.col(0));
    if (!(normal.norm() > 1e-3)) throw std::invalid_argument(run.name + ": parallel to " + other.name);
    line.square_normal = normal.normalized();
    alignment = alignments[first];
  }
  alignments.push_back(alignment);
  const std::size_t square = add(quantity(run.name + ".square_angle", true, run.square_angle));

  std::vector<std::size_t> used;
  for (const std::array<std::size_t, 3>& three : {optic, origin, alignment}) {
    used.insert(used.end(), three.begin(), three.end());
  }
  used.push_back(square);
  used.insert(used.end(), scales.begin(), scales.end());
  for (const ReadingComponent& component : components_) {
    used.push_back(add(quantity(run.name + "." + component.name + ".zero", component.is_angle, SetupNumber::open(0))));
  }
  if (!run.bidirectional) {
    line.approach = 0;
    lines_.push_back(line);
    add(InstrumentItem{run.name, run.moving_body, run.reference_body, used});
    return;
  }
  for (const ReadingComponent& component : components_) {
    SetupQuantity reversal =
        quantity(run.name + "." + component.name + ".reversal", component.is_angle, SetupNumber::open(0));
    reversal.scale = component.is_angle ? 1e-5 : 1e-2;
    used.push_back(add(std::move(reversal)));
  }
  for (const int approach : {1, -1}) {
    line.approach = approach;
    lines_.push_back(line);
    add(InstrumentItem{run.name + (approach > 0 ? "+" : "-"), run.moving_body, run.reference_body, used});
  }
}

double Interferometer::standard_uncertainty(const InstrumentReadings& readings, std::size_t reading,
                                            std::size_t component) const {
  if (components_[component].is_angle) return angle_noise_;
  if (measured_[component] != InterferometerComponent::length) return straightness_noise_;
  const double path = std::abs(readings.measured[component][reading]) + lines_[readings.item[reading]].dead_path;
  return length_noise_ + length_noise_per_length_ * path;
}

std::vector<double> Interferometer::start_values(const Machine& machine, const InstrumentReadings& readings,
                                                 std::vector<std::string>& notes) const {
  std::vector<double> values = Instrument::start_values(machine, readings, notes);
  // The same instrument without zeros, on the nominal machine.
  const auto plain = std::make_shared<Interferometer>(*this);
  for (std::size_t item = 0; item < items_.size(); ++item) {
    for (std::size_t row = 0; row < components_.size(); ++row) {
      SetupQuantity& zero = plain->quantities_[items_[item].quantities[static_cast<std::size_t>(kZero) + row]];
      if (zero.knowledge == Knowledge::open) zero.value = 0;
    }
  }
  const std::vector<std::vector<double>> modelled =
      InstrumentObservations(machine, ErrorSet{}, plain, readings).modelled();
  for (std::size_t row = 0; row < components_.size(); ++row) {
    for (std::size_t item = 0; item < items_.size(); ++item) {
      const std::size_t zero = items_[item].quantities[static_cast<std::size_t>(kZero) + row];
      std::vector<double> differences;
      double low = 0, high = 0, at_low = 0, at_high = 0;
      for (std::size_t k = 0; k < readings.count(); ++k) {
        // Both directions of a bidirectional run share one zero.
        const std::size_t other = readings.item[k];
        if (items_[other].quantities[static_cast<std::size_t>(kZero) + row] != zero) continue;
        const double model = modelled[row][k], measured = readings.measured[row][k];
        if (differences.empty() || model < low) {
          low = model;
          at_low = measured;
        }
        if (differences.empty() || model > high) {
          high = model;
          at_high = measured;
        }
        differences.push_back(measured - model);
      }
      if (differences.empty()) continue;
      if (quantities_[zero].knowledge == Knowledge::open) values[zero] = median(differences);
      const bool first_of_run = item == 0 || items_[item - 1].quantities != items_[item].quantities;
      if (measured_[row] == InterferometerComponent::length && first_of_run && high - low > 1 &&
          at_high - at_low < -0.5 * (high - low)) {
        notes.push_back(
            fmt::format("{}: the indicated length falls where the machine moves along its direction; is the direction "
                        "of the beam or the sign of the indication reversed?",
                        items_[item].name));
      }
    }
  }
  return values;
}

std::optional<MeetingPoints> Interferometer::meeting_points(std::size_t item) const {
  const auto at = [&](std::size_t first) -> Eigen::Vector3d {
    const std::vector<std::size_t>& q = items_[item].quantities;
    return {quantities_[q[first]].value, quantities_[q[first + 1]].value, quantities_[q[first + 2]].value};
  };
  return MeetingPoints{at(kOptic), at(kOrigin)};
}

template <typename S>
Eigen::Matrix<S, 3, 3> Interferometer::beam_axes(const Line& line, const S* quantities) const {
  using std::cos;
  using std::sin;
  const S cr = cos(quantities[kAlignment]), sr = sin(quantities[kAlignment]);
  const S cp = cos(quantities[kAlignment + 1]), sp = sin(quantities[kAlignment + 1]);
  const S cy = cos(quantities[kAlignment + 2]), sy = sin(quantities[kAlignment + 2]);
  Eigen::Matrix<S, 3, 3> aligned;  // Rz(yaw) Ry(pitch) Rx(roll)
  aligned << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr, sy * cp, sy * sp * sr + cy * cr,
      sy * sp * cr - cy * sr, -sp, cp * sr, cp * cr;
  Eigen::Matrix<S, 3, 3> first = line.first_axes.cast<S>() * aligned;
  if (line.square_normal.isZero(0)) return first;
  // Rodrigues: the square turns the reference of the first run, and everything aligned with it.
  const S c = cos(quantities[kSquare]), s = sin(quantities[kSquare]);
  Eigen::Matrix<S, 3, 3> squared;
  for (int j = 0; j < 3; ++j) {
    const Eigen::Vector3d column = line.nominal_axes.col(j), turned = line.square_normal.cross(column);
    const Eigen::Vector3d along = line.square_normal * line.square_normal.dot(column);
    for (int i = 0; i < 3; ++i) squared(i, j) = c * S(column[i] - along[i]) + s * S(turned[i]) + S(along[i]);
  }
  return first * (line.first_axes.transpose().cast<S>() * squared);
}

template <typename S>
void Interferometer::equation(std::size_t item, const SeenBody<S>& seen, const S* quantities, const double*,
                              S* reading) const {
  using std::asin;
  using std::atan2;
  using Vector = Eigen::Matrix<S, 3, 1>;
  const Line& line = lines_[item];
  const Eigen::Matrix<S, 3, 3> axes = beam_axes(line, quantities);
  const Vector optic(quantities[kOptic], quantities[kOptic + 1], quantities[kOptic + 2]);
  const Vector origin(quantities[kOrigin], quantities[kOrigin + 1], quantities[kOrigin + 2]);
  const Vector v = seen.point(optic) - origin;
  const Eigen::Matrix<S, 3, 3> turn = seen.rotation * line.orientation_transpose.cast<S>();
  const auto carried = [&](int axis) { return Vector(turn * axes.col(axis)); };
  const auto across = [&](int axis) {
    return line.reflector_moves ? S(carried(axis).dot(v)) : S(axes.col(axis).dot(v));
  };
  const S scale_length = S(1) + quantities[kScale], scale_straightness = S(1) + quantities[kScale + 1],
          scale_angle = S(1) + quantities[kScale + 2];
  for (std::size_t row = 0; row < measured_.size(); ++row) {
    S value(0);
    switch (measured_[row]) {
      case InterferometerComponent::length:
        if (line.target == LengthTarget::retroreflector) {
          value = scale_length * S(axes.col(0).dot(v));
        } else {
          const Vector normal = carried(0);
          value = scale_length * S(normal.dot(v)) * S(normal.dot(axes.col(0)));
        }
        break;
      case InterferometerComponent::straightness_y:
        value = scale_straightness * across(1);
        break;
      case InterferometerComponent::straightness_z:
        value = scale_straightness * across(2);
        break;
      case InterferometerComponent::roll: {
        const Vector side = carried(1);
        value = scale_angle * atan2(S(axes.col(2).dot(side)), S(axes.col(1).dot(side)));
        break;
      }
      case InterferometerComponent::pitch:
        value = scale_angle * asin(S(axes.col(0).dot(carried(2))));
        break;
      case InterferometerComponent::yaw:
        value = scale_angle * asin(S(-axes.col(0).dot(carried(1))));
        break;
    }
    value += quantities[static_cast<std::size_t>(kZero) + row];
    if (line.approach != 0) {
      value += S(0.5 * line.approach) * quantities[static_cast<std::size_t>(kZero) + measured_.size() + row];
    }
    reading[row] = value;
  }
}

template class EquationInstrument<Interferometer, 25, 6>;

}  // namespace abbe
