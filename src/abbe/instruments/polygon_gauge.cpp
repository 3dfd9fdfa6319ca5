#include "abbe/instruments/polygon_gauge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "abbe/geometry/rotation.h"
#include "abbe/instruments/interferometer.h"

namespace abbe {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr const char* kSix[] = {"tilt_x", "tilt_y", "turn", "x", "y", "z"};

SetupQuantity known(std::string name, bool is_angle, double value, const PolygonKnowledge& knowledge) {
  const double uncertainty = is_angle ? knowledge.angle_uncertainty : knowledge.length_uncertainty;
  return quantity(std::move(name), is_angle,
                  {value, knowledge.knowledge, knowledge.knowledge == Knowledge::within ? uncertainty : 0});
}

void check(const PolygonGaugeSetup& setup) {
  const auto refuse = [&](const std::string& what) { throw std::invalid_argument(setup.name + ": " + what); };
  if (setup.polygon.order != PolygonFaceOrder::face) refuse("expected the tilt of a face as a constant of the face");
  validate(setup.polygon, setup.bench);
  regular_position(setup.polygon.faces.size(), 0);  // a number of faces that will not do is refused here
  if (setup.shifts.empty()) refuse("expected at least one mount");
  if (!setup.mounts.empty() && setup.mounts.size() != setup.shifts.size()) {
    refuse(fmt::format("{} mounts and {} turns in faces, expected as many", setup.mounts.size(), setup.shifts.size()));
  }
  if (setup.measured.empty() || setup.measured.size() > 6) {
    refuse(fmt::format("{} numbers per reading, expected 1 to 6", setup.measured.size()));
  }
  for (const PolygonReading reading : setup.measured) {
    if (std::count(setup.measured.begin(), setup.measured.end(), reading) > 1) {
      refuse(fmt::format("{} is measured twice", reading_name(reading)));
    }
  }
  if (!(setup.noise.angle > 0) || !(setup.noise.length > 0)) refuse("expected noise above zero, in rad and mm");
}

}  // namespace

PolygonGauge::PolygonGauge(const PolygonGaugeSetup& setup) : EquationInstrument(setup.name), setup_(setup) {
  check(setup_);
  const std::size_t faces = setup_.polygon.faces.size();
  if (setup_.mounts.empty()) setup_.mounts.resize(setup_.shifts.size());
  for (std::size_t i = 0; i < kPolygonReadings; ++i) {
    axes_[i] = rotation_from_error_angles(setup_.bench.sensor(static_cast<PolygonReading>(i)).angles);
  }
  for (const PolygonReading reading : setup_.measured)
    components_.push_back({reading_name(reading), is_angle(reading)});

  std::vector<std::array<std::size_t, 6>> mounts;
  for (std::size_t m = 0; m < setup_.mounts.size(); ++m) {
    mounts.emplace_back();
    for (std::size_t i = 0; i < 6; ++i) {
      const PolygonMount& mount = setup_.mounts[m];
      const double value = i < 3 ? mount.angles[static_cast<int>(i)] : mount.offset[static_cast<int>(i) - 3];
      mounts[m][i] =
          add(known(fmt::format("{}.mount{}.{}", name_, m + 1, kSix[i]), i < 3, value, setup_.mount_knowledge));
    }
  }
  std::vector<std::array<std::size_t, 3>> planes;
  for (std::size_t j = 0; j < faces; ++j) {
    const PolygonFace& face = setup_.polygon.faces[j];
    const std::string of = fmt::format("{}.face{}.", name_, j + 1);
    planes.push_back({add(known(of + "azimuth_error", true, face.azimuth_error, setup_.face_knowledge)),
                      add(known(of + "tilt", true, face.tilt, setup_.face_knowledge)),
                      add(known(of + "distance", false, face.distance, setup_.face_knowledge))});
  }
  const std::size_t top[] = {add(known(name_ + ".top.tilt_x", true, setup_.polygon.top.tilt_x, setup_.top_knowledge)),
                             add(known(name_ + ".top.tilt_y", true, setup_.polygon.top.tilt_y, setup_.top_knowledge))};
  std::vector<std::size_t> zeros;
  for (const PolygonReading reading : setup_.measured) {
    zeros.push_back(add(known(fmt::format("{}.zero.{}", name_, reading_name(reading)), is_angle(reading),
                              setup_.zeros[static_cast<std::size_t>(reading)], setup_.zero_knowledge)));
  }
  for (std::size_t m = 0; m < setup_.mounts.size(); ++m) {
    setup_.mounts[m].turn = kTurn * static_cast<double>(setup_.shifts[m]) / static_cast<double>(faces);
    for (std::size_t x = 0; x < faces; ++x) {
      const std::size_t y = (x + faces - faces / 4) % faces;
      InstrumentItem item{fmt::format("mount{}.face{}", m + 1, x + 1), setup_.table_body, setup_.sensor_body, {}};
      item.quantities.insert(item.quantities.end(), mounts[m].begin(), mounts[m].end());
      item.quantities.insert(item.quantities.end(), planes[x].begin(), planes[x].end());
      item.quantities.insert(item.quantities.end(), planes[y].begin(), planes[y].end());
      item.quantities.insert(item.quantities.end(), std::begin(top), std::end(top));
      item.quantities.insert(item.quantities.end(), zeros.begin(), zeros.end());
      add(std::move(item));
      nominal_.push_back({setup_.mounts[m].turn, setup_.polygon.faces[x].azimuth, setup_.polygon.faces[y].azimuth});
    }
  }
}

double PolygonGauge::standard_uncertainty(const InstrumentReadings&, std::size_t, std::size_t component) const {
  return components_[component].is_angle ? setup_.noise.angle : setup_.noise.length;
}

InstrumentReadings polygon_plan(const Machine& machine, const PolygonGauge& gauge, std::size_t axis,
                                std::vector<double> positions) {
  const PolygonGaugeSetup& setup = gauge.setup();
  const std::size_t faces = setup.polygon.faces.size();
  const double step = kTurn / static_cast<double>(faces), first = positions.at(axis);
  InstrumentReadings plan;
  for (std::size_t m = 0; m < setup.shifts.size(); ++m) {
    for (std::size_t k = 0; k < faces; ++k) {
      positions[axis] = first + step * static_cast<double>(k);
      const Eigen::Matrix3d bench_from_prism =
          setup.sensors_from_bench.rotation.transpose() *
          nominal_orientation(machine, positions, setup.table_body, setup.sensor_body) *
          setup.table_from_prism.rotation * rotation_about(Eigen::Vector3d::UnitZ(), setup.mounts[m].turn);
      const auto normal = [&](std::size_t face) -> Eigen::Vector3d {
        const double azimuth = setup.polygon.faces[face].azimuth;
        return bench_from_prism * Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), 0);
      };
      std::size_t nearest = 0;
      for (std::size_t j = 1; j < faces; ++j) {
        if (normal(j).x() > normal(nearest).x()) nearest = j;
      }
      const double miss_x = std::acos(std::clamp(normal(nearest).x(), -1.0, 1.0));
      const double miss_y = std::acos(std::clamp(normal((nearest + faces - faces / 4) % faces).y(), -1.0, 1.0));
      // A few minutes of arc are the range of an autocollimator; what is beyond a tenth of a face is another position.
      if (std::max(miss_x, miss_y) > 0.1 * step) {
        throw std::invalid_argument(fmt::format(
            "{}: with {} at {:.6g} deg the nearest face looks {:.3g} deg aside of the sensors, expected a face every "
            "{:.6g} deg",
            gauge.name(), machine.axes[axis].name, positions[axis] * 180 / std::numbers::pi,
            std::max(miss_x, miss_y) * 180 / std::numbers::pi, step * 180 / std::numbers::pi));
      }
      plan.append(positions, m * faces + nearest);
    }
  }
  return plan;
}

}  // namespace abbe
