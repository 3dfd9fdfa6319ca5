#include "abbe/instruments/polygon/polygon_gauge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "abbe/geometry/angle_units.h"
#include "abbe/geometry/rotation.h"
#include "abbe/instruments/equation_instrument_inline.h"
#include "abbe/instruments/polygon/polygon_placement.h"

namespace abbe {
namespace {

using Face = PolygonGaugeSetup::Face;
using Mount = PolygonGaugeSetup::Mount;
using Step = PolygonGaugeSetup::Step;

constexpr const char* kSix[] = {"tilt_x", "tilt_y", "turn", "x", "y", "z"};

/// Name of a component that several steps have in common.
std::string common_name(PolygonReading reading) {
  using enum PolygonReading;
  if (!is_angle(reading)) return "displacement";
  const bool about_z = reading == autocollimator_x_about_z || reading == autocollimator_y_about_z;
  return about_z ? "autocollimator_about_z" : "autocollimator_tilt";
}

void check_step(const PolygonGaugeSetup& setup, const Step& step) {
  const auto refuse = [&](const std::string& what) { throw std::invalid_argument(setup.name + ": " + what); };
  if (step.measured.empty() || step.measured.size() > 6) {
    refuse(fmt::format("{} numbers per reading, expected 1 to 6", step.measured.size()));
  }
  for (const PolygonReading reading : step.measured) {
    if (std::count(step.measured.begin(), step.measured.end(), reading) > 1) {
      refuse(fmt::format("{} is measured twice", reading_name(reading)));
    }
  }
  if (!step.zeros.empty() && step.zeros.size() != step.measured.size()) {
    refuse(fmt::format("{} zeros of {} readings", step.zeros.size(), step.measured.size()));
  }
  const std::vector<PolygonReading>& first = setup.steps.front().measured;
  const bool same = std::equal(first.begin(), first.end(), step.measured.begin(), step.measured.end(),
                               [](PolygonReading a, PolygonReading b) { return common_name(a) == common_name(b); });
  if (!same && setup.steps.size() > 1) refuse("the steps measure different kinds of readings");
}

void check(const PolygonGaugeSetup& setup) {
  const auto refuse = [&](const std::string& what) { throw std::invalid_argument(setup.name + ": " + what); };
  if (setup.polygon.order != PolygonFaceOrder::face) refuse("expected the tilt of a face as a constant of the face");
  validate(setup.polygon, setup.bench);
  regular_position(setup.polygon.faces.size(), 0);  // a number of faces that will not do is refused here
  if (setup.mounts.empty()) refuse("expected at least one mount");
  if (setup.steps.empty()) refuse("expected at least one step");
  if (!setup.faces.empty() && setup.faces.size() != setup.polygon.faces.size()) {
    refuse(fmt::format("errors of {} faces, expected {}", setup.faces.size(), setup.polygon.faces.size()));
  }
  for (const Step& step : setup.steps) check_step(setup, step);
  if (!(setup.noise.angle > 0) || !(setup.noise.length > 0)) refuse("expected noise above zero, in rad and mm");
}

/// `text` with a point behind it, unless it is empty.
std::string prefix(const std::string& text) { return text.empty() ? "" : text + "."; }

}  // namespace

Step PolygonGaugeSetup::all_at_once() {
  using enum PolygonReading;
  return {"",
          {autocollimator_x_about_z, autocollimator_x_about_y, autocollimator_y_about_x, displacement_x, displacement_y,
           displacement_z},
          {}};
}

PolygonGauge::PolygonGauge(const PolygonGaugeSetup& setup) : EquationInstrument(setup.name), setup_(setup) {
  check(setup_);
  const std::size_t faces = setup_.polygon.faces.size();
  for (std::size_t j = setup_.faces.size(); j < faces; ++j) {
    const PolygonFace& face = setup_.polygon.faces[j];
    setup_.faces.push_back(
        {SetupNumber::open(face.azimuth_error), SetupNumber::open(face.tilt), SetupNumber::open(face.distance)});
  }
  for (std::size_t i = 0; i < kPolygonReadings; ++i) {
    axes_[i] = rotation_from_error_angles(setup_.bench.sensor(static_cast<PolygonReading>(i)).angles);
  }
  for (const PolygonReading reading : setup_.steps.front().measured) {
    components_.push_back({steps() > 1 ? common_name(reading) : reading_name(reading), is_angle(reading)});
  }

  std::vector<std::array<std::size_t, 6>> mounts;
  for (const Mount& mount : setup_.mounts) {
    mounts.emplace_back();
    for (std::size_t i = 0; i < 6; ++i) {
      mounts.back()[i] = add(quantity(fmt::format("{}.{}.{}", name_, mount.name, kSix[i]), i < 3, mount.numbers[i]));
    }
  }
  std::vector<std::array<std::size_t, 3>> planes;
  for (std::size_t j = 0; j < faces; ++j) {
    const Face& face = setup_.faces[j];
    const std::string of = fmt::format("{}.face{}.", name_, j + 1);
    planes.push_back({add(quantity(of + "azimuth_error", true, face.azimuth_error)),
                      add(quantity(of + "tilt", true, face.tilt)),
                      add(quantity(of + "distance", false, face.distance))});
  }
  const std::size_t top[] = {add(quantity(name_ + ".top.tilt_x", true, setup_.top[0])),
                             add(quantity(name_ + ".top.tilt_y", true, setup_.top[1]))};
  std::vector<std::vector<std::size_t>> zeros;
  for (const Step& step : setup_.steps) {
    zeros.emplace_back();
    for (std::size_t i = 0; i < step.measured.size(); ++i) {
      zeros.back().push_back(
          add(quantity(fmt::format("{}.{}zero.{}", name_, prefix(step.name), reading_name(step.measured[i])),
                       is_angle(step.measured[i]), step.zeros.empty() ? SetupNumber::open(0) : step.zeros[i])));
    }
  }
  const std::vector<std::string> targets = target_names();
  for (std::size_t target = 0; target < targets.size(); ++target) {
    const std::size_t m = target / steps(), step = target % steps();
    const double turn = kTurn * static_cast<double>(setup_.mounts[m].turned_by) / static_cast<double>(faces);
    for (std::size_t x = 0; x < faces; ++x) {
      const std::size_t y = (x + faces - faces / 4) % faces;
      InstrumentItem item{fmt::format("{}.face{}", targets[target], x + 1), setup_.table_body, setup_.sensor_body, {}};
      const auto use = [&](const auto& quantities) {
        item.quantities.insert(item.quantities.end(), std::begin(quantities), std::end(quantities));
      };
      use(mounts[m]);
      use(planes[x]);
      use(planes[y]);
      use(top);
      use(zeros[step]);
      add(std::move(item));
      nominal_.push_back({step, turn, setup_.polygon.faces[x].azimuth, setup_.polygon.faces[y].azimuth});
    }
  }
}

double PolygonGauge::standard_uncertainty(const InstrumentReadings&, std::size_t, std::size_t component) const {
  return components_[component].is_angle ? setup_.noise.angle : setup_.noise.length;
}

std::vector<std::string> PolygonGauge::target_names() const {
  std::vector<std::string> names;
  for (const Mount& mount : setup_.mounts) {
    for (const Step& step : setup_.steps) names.push_back(steps() > 1 ? mount.name + "." + step.name : mount.name);
  }
  return names;
}

std::size_t PolygonGauge::item_at(const Machine& machine, std::size_t target, std::size_t,
                                  const std::vector<double>& positions) const {
  const Polygon& polygon = setup_.polygon;
  const std::size_t faces = polygon.faces.size();
  const double step = kTurn / static_cast<double>(faces);
  const double turn = nominal_[target * faces].turn;
  const RigidTransform bench_from_prism =
      setup_.sensors_from_bench.inverse() * nominal_seen(machine, positions, setup_.table_body, setup_.sensor_body) *
      setup_.table_from_prism * RigidTransform::rotate(rotation_about(Eigen::Vector3d::UnitZ(), turn));
  const auto in_prism = [&](std::size_t face) -> Eigen::Vector3d {
    return {std::cos(polygon.faces[face].azimuth), std::sin(polygon.faces[face].azimuth), 0};
  };
  const auto cosine = [&](std::size_t face, int axis) { return (bench_from_prism.rotation * in_prism(face))[axis]; };
  std::size_t seen[2] = {0, 0};
  for (std::size_t j = 1; j < faces; ++j) {
    if (cosine(j, 0) > cosine(seen[0], 0)) seen[0] = j;
  }
  seen[1] = (seen[0] + faces - faces / 4) % faces;
  const auto refuse = [](const std::string& what) { throw std::invalid_argument(what); };
  const double miss = std::acos(std::clamp(std::min(cosine(seen[0], 0), cosine(seen[1], 1)), -1.0, 1.0));
  // A few minutes of arc are the range of an autocollimator; what is beyond a tenth of a face is another position.
  if (miss > 0.1 * step) {
    refuse(fmt::format("the nearest face looks {:.3g} deg aside of the sensors, expected a face every {:.6g} deg",
                       miss / kDegree, step / kDegree));
  }
  for (const PolygonReading reading : setup_.steps[target % steps()].measured) {
    const PolygonSensor& sensor = setup_.bench.sensor(reading);
    const Eigen::Vector3d start = bench_from_prism.inverse() * Eigen::Vector3d(sensor.position + sensor.exit);
    const int side = static_cast<int>(sensor.side);
    const Eigen::Vector3d normal = side == 2 ? Eigen::Vector3d::UnitZ() : in_prism(seen[side]);
    const double distance = polygon.faces.front().distance;
    const double aside = Eigen::Vector3d(start - start.dot(normal) * normal).head<2>().norm();
    const bool on_it = side == 2 ? aside <= distance && start.z() > polygon.top.height
                                 : aside <= polygon.half_face_width() && start.z() >= 0 &&
                                       start.z() <= polygon.top.height && start.dot(normal) > distance;
    if (!on_it) {
      refuse(fmt::format("the beam of {} misses the prism: its sensor stands at [{:.4g}, {:.4g}, {:.4g}] mm of it",
                         reading_name(reading), start.x(), start.y(), start.z()));
    }
  }
  return target * faces + seen[0];
}

InstrumentReadings polygon_plan(const Machine& machine, const PolygonGauge& gauge, std::size_t axis,
                                std::vector<double> positions) {
  const std::size_t faces = gauge.setup().polygon.faces.size(), targets = gauge.target_names().size();
  const double step = kTurn / static_cast<double>(faces), first = positions.at(axis);
  InstrumentReadings plan;
  for (std::size_t target = 0; target < targets; ++target) {
    for (std::size_t k = 0; k < faces; ++k) {
      positions[axis] = first + step * static_cast<double>(k);
      plan.append(positions, gauge.item_at(machine, target, 0, positions));
    }
  }
  return plan;
}

template <typename S>
void PolygonGauge::equation(std::size_t item, const SeenBody<S>& seen, const S* q, const double*, S* reading) const {
  using Vector = Eigen::Matrix<S, 3, 1>;
  using std::cos;
  using std::sin;
  const auto turned = [](const Vector& v, int axis, const S& c, const S& s) {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    Vector result = v;
    result[a] = c * v[a] - s * v[b];
    result[b] = s * v[a] + c * v[b];
    return result;
  };
  const Seen& nominal = nominal_[item];
  const std::vector<PolygonReading>& measured = setup_.steps[nominal.step].measured;
  const S mount_c[3] = {cos(q[kMount]), cos(q[kMount + 1]), cos(q[kMount + 2] + S(nominal.turn))};
  const S mount_s[3] = {sin(q[kMount]), sin(q[kMount + 1]), sin(q[kMount + 2] + S(nominal.turn))};
  const Vector offset(q[kMount + 3], q[kMount + 4], q[kMount + 5]);
  const auto constant = [](const Eigen::Vector3d& v) { return Vector(S(v[0]), S(v[1]), S(v[2])); };
  const auto times = [](const Eigen::Matrix3d& m, const Vector& v) {
    Vector result;
    for (int i = 0; i < 3; ++i) result[i] = S(m(i, 0)) * v[0] + S(m(i, 1)) * v[1] + S(m(i, 2)) * v[2];
    return result;
  };
  const Eigen::Matrix3d to_bench = setup_.sensors_from_bench.rotation.transpose();

  // The three planes in the bench, those that are read.
  Vector normals[3];
  S offsets[3];
  bool known[3] = {false, false, false};
  const auto plane = [&](int side) {
    if (known[side]) return;
    known[side] = true;
    Vector normal;
    S distance = S(setup_.polygon.top.height);
    if (side == 2) {
      const S sx = sin(q[kTop]), cx = cos(q[kTop]), sy = sin(q[kTop + 1]), cy = cos(q[kTop + 1]);
      normal = Vector(-sy, cy * sx, cy * cx);
    } else {
      const int face = side == 0 ? kFaceX : kFaceY;
      const S azimuth = q[face] + S(side == 0 ? nominal.azimuth_x : nominal.azimuth_y);
      const S flat = cos(q[face + 1]);
      normal = Vector(cos(azimuth) * flat, sin(azimuth) * flat, sin(q[face + 1]));
      distance = q[face + 2];
    }
    normal =
        turned(turned(turned(normal, 2, mount_c[2], mount_s[2]), 0, mount_c[0], mount_s[0]), 1, mount_c[1], mount_s[1]);
    const Vector on_plane = normal * distance + offset;
    const Vector in_table = times(setup_.table_from_prism.rotation, normal);
    const Vector point =
        times(setup_.table_from_prism.rotation, on_plane) + constant(setup_.table_from_prism.translation);
    const Vector seen_point = seen.point(point) - constant(setup_.sensors_from_bench.translation);
    normals[side] = times(to_bench, seen.direction(in_table));
    offsets[side] = normals[side].dot(times(to_bench, seen_point));
  };

  for (std::size_t row = 0; row < measured.size(); ++row) {
    const PolygonReading kind = measured[row];
    const PolygonSensor& sensor = setup_.bench.sensor(kind);
    const int side = static_cast<int>(sensor.side);
    plane(side);
    const Eigen::Matrix3d& axes = axes_[static_cast<std::size_t>(kind)];
    const S along = normals[side].dot(constant(axes.col(side)));
    if (is_angle(kind)) {
      const PolygonAcross across = across_of(kind);
      const S aside = normals[side].dot(constant(axes.col(across.axis)));
      reading[row] = S(across.sign) * along * aside / (S(2) * along * along - S(1));
    } else {
      const Eigen::Vector3d start = sensor.position + axes * sensor.exit;
      reading[row] = S(sensor.exit[side]) + (offsets[side] - normals[side].dot(constant(start))) / along;
    }
    reading[row] += q[kZero + static_cast<int>(row)];
  }
}

template class EquationInstrument<PolygonGauge, 20, 6>;

}  // namespace abbe
