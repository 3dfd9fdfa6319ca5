#pragma once

#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string>

#include "abbe/geometry/rotation.h"
#include "abbe/instruments/trackers/tracker.h"

/// tests/golden/aguado as data of this project: its README says what the files hold.
namespace abbe::test {

struct AguadoCase {
  Machine machine;
  ErrorSet truth;
  TrackerSetup setup;  ///< with the true pose; three reflectors
  nlohmann::json json;
};

inline std::string golden_aguado(const std::string& file) { return ABBE_GOLDEN "/aguado/" + file; }

inline Eigen::Vector3d vector_of(const nlohmann::json& json, std::size_t first = 0) {
  return {json[first].get<double>(), json[first + 1].get<double>(), json[first + 2].get<double>()};
}

inline AguadoCase aguado_case() {
  AguadoCase result;
  std::ifstream file(golden_aguado("truth.json"));
  if (!file) throw std::runtime_error("no " + golden_aguado("truth.json"));
  result.json = nlohmann::json::parse(file);
  const nlohmann::json& truth = result.json;
  const Eigen::Vector3d c0 = vector_of(truth["C0"]), z0 = vector_of(truth["Z0"]);
  const double turn = 2 * std::numbers::pi;

  Axis c{.name = "C", .kind = AxisKind::rotary, .side = ChainSide::workpiece, .primed = true};
  c.direction = Eigen::Vector3d::UnitZ();
  c.point = c0;
  c.travel_max = turn;
  Axis x{.name = "X", .kind = AxisKind::linear, .side = ChainSide::workpiece, .primed = true};
  x.travel_max = 1400;
  Axis z{.name = "Z", .kind = AxisKind::linear, .side = ChainSide::tool};
  z.direction = Eigen::Vector3d::UnitZ();
  z.point = z0;
  z.travel_max = 600;
  result.machine.name = "Aguado";
  result.machine.axes = {c, x, z};
  result.machine.bed_from_workpiece = RigidTransform::translate(c0);
  result.machine.tool_reference = z0;

  const char* tables[] = {"C_fourier_rows_1_c1_s1_c2_s2", "X_legendre_rows_P0_Pn_cols_dx_dy_dz_EA_EB_EC", "Z_legendre"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (int component = 0; component < kComponentCount; ++component) {
      ErrorMotion motion;
      motion.axis = axis;
      motion.component = static_cast<Component>(component);
      motion.basis.kind = axis == 0 ? BasisKind::fourier : BasisKind::legendre;
      motion.basis.order = 4;
      motion.basis.to = result.machine.axes[axis].travel_max;
      motion.basis.period = axis == 0 ? turn : 0;
      for (const nlohmann::json& row : truth[tables[axis]]) {
        motion.coefficients.push_back(row[static_cast<std::size_t>(component)].get<double>());
      }
      result.truth.motions.push_back(motion);
    }
  }
  TrackerStation station;
  station.noise = TrackerNoise::isotropic(10, 5);
  station.body_from_tracker = {rotation_from_error_angles(vector_of(truth["lt"], 3)), vector_of(truth["lt"])};
  result.setup.stations = {station};
  for (std::size_t i = 0; i < 3; ++i) {
    Reflector reflector;
    reflector.name = "reflector" + std::to_string(i + 1);
    reflector.offset = vector_of(truth["offsets"][i]);
    result.setup.reflectors.push_back(reflector);
  }
  return result;
}

inline TrackerReadings aguado_readings(const AguadoCase& aguado, const std::string& file_name) {
  TrackerReadings readings;
  readings.reserve(3, 5000);
  std::ifstream file(golden_aguado(file_name));
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    double v[9];
    std::istringstream fields(line);
    for (double& value : v) {
      fields >> value;
      fields.ignore(1);
    }
    readings.poses.axis[0].push_back(v[2] * std::numbers::pi / 180);
    readings.poses.axis[1].push_back(v[0]);
    readings.poses.axis[2].push_back(v[1]);
    std::uint16_t reflector = 0;
    while ((aguado.setup.reflectors.at(reflector).offset - Eigen::Vector3d(v[3], v[4], v[5])).norm() > 1e-9)
      ++reflector;
    readings.station.push_back(0);
    readings.reflector.push_back(reflector);
    for (std::size_t k = 0; k < 3; ++k) readings.measured[k].push_back(v[6 + k]);
  }
  return readings;
}

}  // namespace abbe::test
