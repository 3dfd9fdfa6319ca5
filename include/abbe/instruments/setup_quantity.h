#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <utility>

namespace abbe {

/// How well a number of the set-up is known before the measurement.
enum class Knowledge {
  exact,   ///< taken as it is
  within,  ///< known with a standard uncertainty, and estimated
  open     ///< estimated from the readings alone
};

/// A number of a set-up and how well it is known; mm, rad or a pure number.
struct SetupNumber {
  double value = 0;  ///< start of the estimate, or the value itself; in a simulation the true one
  Knowledge knowledge = Knowledge::exact;
  double standard_uncertainty = 0;  ///< of `value` for Knowledge::within, > 0
  std::optional<double> truth{};    ///< simulation: what it really is, where that was stated

  static SetupNumber exact(double value) { return {value, Knowledge::exact, 0, {}}; }
  static SetupNumber within(double value, double uncertainty) { return {value, Knowledge::within, uncertainty, {}}; }
  static SetupNumber open(double start) { return {start, Knowledge::open, 0, {}}; }
};

/// Three of them: a point, mm.
struct SetupPoint {
  std::array<SetupNumber, 3> coordinate;

  static SetupPoint exact(const Eigen::Vector3d& point) {
    return {{SetupNumber::exact(point[0]), SetupNumber::exact(point[1]), SetupNumber::exact(point[2])}};
  }
  static SetupPoint within(const Eigen::Vector3d& point, double uncertainty) {
    return {{SetupNumber::within(point[0], uncertainty), SetupNumber::within(point[1], uncertainty),
             SetupNumber::within(point[2], uncertainty)}};
  }
  static SetupPoint open(const Eigen::Vector3d& start) {
    return {{SetupNumber::open(start[0]), SetupNumber::open(start[1]), SetupNumber::open(start[2])}};
  }
  Eigen::Vector3d value() const { return {coordinate[0].value, coordinate[1].value, coordinate[2].value}; }
};

/// A ball or a sphere by its centre, mm; frame of the body that carries it (tool: from the gauge point).
struct NamedPoint {
  std::string name;
  SetupPoint centre;
};

/// A named number of the set-up: the length of a bar, a coordinate of a ball, the zero of an indication.
struct SetupQuantity : SetupNumber {
  std::string name;             ///< with the set-up's name in front: "bar1.length", "table_ball.x"
  bool is_angle = false;        ///< rad if true; mm if false
  double scale = 1;             ///< typical size for scaling, > 0
  bool is_pure_number = false;  ///< neither mm nor rad, whatever `is_angle` says: a scale, written in um/m
};

/// @param name  with the set-up's name in front
inline SetupQuantity quantity(std::string name, bool is_angle, const SetupNumber& number) {
  return {number, std::move(name), is_angle, is_angle ? 1e-3 : 1.0, false};
}

/// A scale: length per length, or angle per angle.
inline SetupQuantity pure_number(std::string name, const SetupNumber& number) {
  return {number, std::move(name), false, 1e-6, true};
}

}  // namespace abbe
