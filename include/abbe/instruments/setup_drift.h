#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "abbe/instruments/observations.h"

namespace abbe {

/// A place of a set-up that moves slowly against the body on which it stands: a station, a ball, a straightedge.
///
/// Since the first reading it has moved by d(t) and has turned by exp(w(t)) about its pivot, both in the frame of the
/// body. Every component of (d, w) that drifts is
///
///     sum over k = 1 .. degree of a_k s^k  +  W(t),    s = (t - start)/(end - start)
///
/// and W runs in straight lines between its values at the knots, 0 at the first one.
struct DriftingPlace {
  std::string name;                                 ///< "tracker1"
  Eigen::Vector3d pivot = Eigen::Vector3d::Zero();  ///< mm, frame of the body
  std::vector<int> components;                      ///< ascending: 0..2 shift along x, y, z; 3..5 turn about them
  double start_s = 0, end_s = 1;                    ///< first and last reading
  int degree = 0;                                   ///< 0: no polynomial
  std::vector<double> knots_s{};                    ///< increasing, from start to end; empty: no walk

  /// Unknowns of every component: the coefficients, then the values at all knots but the first.
  std::size_t functions() const {
    return static_cast<std::size_t>(degree) + (knots_s.empty() ? 0 : knots_s.size() - 1);
  }
};

/// The drift of a set-up: further unknowns of its observations, behind those of the instrument.
///
/// Order of the unknowns: places, components, functions.
struct SetupDrift {
  std::vector<DriftingPlace> places;  ///< [stations of the instrument, or 1]
  std::vector<double> values;         ///< [unknowns] where they start, or their truth; mm or rad

  std::size_t unknown_count() const;
  std::size_t first_unknown(std::size_t place, std::size_t component) const;
  /// "tracker1.drift_x[P1]", "tracker1.drift_rz(1.5 h)": the time since the first reading.
  std::vector<SetupUnknown> unknowns() const;
};

/// "x", "y", "z", "rx", "ry", "rz".
const char* drift_component_name(int component);

/// Weights of the functions of a place at a time; outside start to end it stays as it was there.
/// @param weights  out, [functions()]
void drift_functions(const DriftingPlace& place, double time_s, double* weights);

/// What the drift of its set-up does to every reading.
///
/// With c the pivot and E = exp(w), a body that the instrument would see at the origin o, turned by R, is seen at
/// E'(o - c - d) + c, turned by E'R.
class ReadingDrift {
 public:
  ReadingDrift() = default;  ///< none
  /// @param drift  null: none
  /// @param place  [readings] place from which it was taken
  /// @throws std::invalid_argument where the readings have no times
  ReadingDrift(std::shared_ptr<const SetupDrift> drift, std::span<const double> time_s,
               std::vector<std::uint16_t> place);

  bool acts() const { return drift_ != nullptr; }
  std::size_t unknown_count() const { return acts() ? drift_->unknown_count() : 0; }
  const SetupDrift* drift() const { return drift_.get(); }
  /// @param values  [unknown_count()] mm or rad
  void set(std::span<const double> values);

  /// A point as the moved instrument sees it.
  Eigen::Vector3d seen(std::size_t reading, const Eigen::Vector3d& point) const;
  /// E of the reading.
  Eigen::Matrix3d turn(std::size_t reading) const;

  /// Derivatives of a modelled number by (d, w).
  /// @param seen    origin of the body as the moved instrument sees it
  /// @param force   derivative by its shift, moment by its turn about that origin, both in the moved frame
  Eigen::Matrix<double, 6, 1> slopes(std::size_t reading, const Eigen::Vector3d& seen, const Eigen::Vector3d& force,
                                     const Eigen::Vector3d& moment) const;
  /// Derivative by an unknown over that by its component; 0 where the unknown is of another place.
  double weight(std::size_t unknown, std::size_t reading) const;
  int component_of(std::size_t unknown) const { return component_[unknown]; }

 private:
  std::shared_ptr<const SetupDrift> drift_;
  std::vector<double> time_s_;
  std::vector<std::uint16_t> place_;
  std::vector<int> component_;             ///< [unknowns]
  std::vector<std::size_t> place_of_;      ///< [unknowns]
  std::vector<std::size_t> function_;      ///< [unknowns]
  std::vector<std::size_t> first_weight_;  ///< [readings] into weights_
  std::vector<double> weights_;
  std::vector<Eigen::Matrix<double, 6, 1>> motion_;  ///< [readings]
};

}  // namespace abbe
