#include "abbe/instruments/trackers/pose_tracker_start.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "abbe/errors/chain_plan.h"
#include "abbe/errors/error_states.h"
#include "abbe/geometry/best_fit_transform.h"
#include "abbe/geometry/decompositions.h"

namespace abbe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Index = Eigen::Index;
// Of the largest: singular values nearer to it mean that the rotations do not determine each other.
constexpr double kSingularGap = 1e-6;
// Eigenvalues of the normal matrix of translations, of the largest.
constexpr double kUnseenTranslation = 1e-8;
constexpr std::size_t kFewestPoses = 3;
constexpr double kFarOff = 4.5;  // times the median distance: left out when the translations are fitted again

/// What one reading says: the pose of its target in the frame of the instrument, and the body that carries it.
struct SeenTarget {
  std::size_t target;
  Vector3d position;
  Matrix3d rotation;
  RigidTransform body;
};

std::vector<SeenTarget> seen_targets(const Machine& machine, const PoseTrackerSetup& setup,
                                     const InstrumentReadings& readings) {
  const std::vector<RigidTransform> bodies = seen_bodies(machine, ErrorSet{}, PoseTracker(setup), readings);
  std::vector<SeenTarget> result;
  for (std::size_t k = 0; k < readings.count(); ++k) {
    const Eigen::Quaterniond q(readings.inputs[0][k], readings.inputs[1][k], readings.inputs[2][k],
                               readings.inputs[3][k]);
    result.push_back({readings.item[k],
                      {readings.measured[0][k], readings.measured[1][k], readings.measured[2][k]},
                      q.squaredNorm() > 0 ? q.normalized().toRotationMatrix() : Matrix3d(Matrix3d::Identity()),
                      bodies[k]});
  }
  return result;
}

Vector3d modelled_point(const PoseTrackerSetup& setup, const SeenTarget& seen) {
  return seen.body * setup.targets[seen.target].offset.value();
}

bool has_open_offset(const PoseTrackerSetup::Target& target) {
  return std::any_of(target.offset.coordinate.begin(), target.offset.coordinate.end(),
                     [](const SetupNumber& number) { return number.knowledge == Knowledge::open; });
}

/// Distances between where the instrument saw the targets and where the machine puts them, mm.
std::vector<double> distances(const PoseTrackerSetup& setup, const std::vector<SeenTarget>& all) {
  std::vector<double> result;
  for (const SeenTarget& seen : all) {
    result.push_back((setup.body_from_station * seen.position - modelled_point(setup, seen)).norm());
  }
  return result;
}

double median_of(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::infinity();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Both rotations of R_s R_k = A_k M from the readings of one target; nothing where they do not determine each other.
std::optional<std::pair<Matrix3d, Matrix3d>> rotations_of(const std::vector<SeenTarget>& seen) {
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(9, 9);
  for (const SeenTarget& one : seen) {
    for (Index i = 0; i < 3; ++i) {
      for (Index j = 0; j < 3; ++j) {
        mean.block<3, 3>(3 * i, 3 * j) += one.rotation(i, j) * one.body.rotation / static_cast<double>(seen.size());
      }
    }
  }
  // vec(R_s) = (R_k (x) A_k) vec(M), so that both are singular vectors of the mean, of a value near one.
  const SingularValues<> singular(mean);
  if (!(singular.values()[0] - singular.values()[1] > kSingularGap * singular.values()[0])) return std::nullopt;
  Matrix3d station = Eigen::Map<const Matrix3d>(singular.u().col(0).eval().data());
  Matrix3d target = Eigen::Map<const Matrix3d>(singular.v().col(0).eval().data());
  if (target.determinant() < 0) {
    target = -target;
    station = -station;
  }
  return std::pair(rotation_from_correlation(station), rotation_from_correlation(target));
}

/// Translations of the station and of the target for a given rotation: t_s - R_b o = t_b - R_s x, least squares.
/// @param use  [seen] 0: left out
bool fit_translations(const std::vector<SeenTarget>& seen, const std::vector<std::uint8_t>& use,
                      const Matrix3d& station, Vector3d& translation, Vector3d& offset) {
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  Matrix6 normal = Matrix6::Zero();
  Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
  for (std::size_t k = 0; k < seen.size(); ++k) {
    if (use[k] == 0) continue;
    Eigen::Matrix<double, 3, 6> row;
    row << Matrix3d::Identity(), -seen[k].body.rotation;
    normal += row.transpose() * row;
    right += row.transpose() * (seen[k].body.translation - station * seen[k].position);
  }
  const SymmetricEigen<6> modes(normal);
  if (!(modes.eigenvalues()[0] > kUnseenTranslation * modes.eigenvalues()[5])) return false;
  const Eigen::Matrix<double, 6, 1> found =
      modes.eigenvectors() * (modes.eigenvectors().transpose() * right).cwiseQuotient(modes.eigenvalues());
  translation = found.head<3>();
  offset = found.tail<3>();
  return true;
}

/// The set-up with the station and one target found from positions and orientations together.
std::optional<PoseTrackerSetup> found_together(const PoseTrackerSetup& given, const std::vector<SeenTarget>& all,
                                               std::size_t target) {
  std::vector<SeenTarget> seen;
  for (const SeenTarget& one : all) {
    if (one.target == target) seen.push_back(one);
  }
  if (seen.size() < kFewestPoses) return std::nullopt;
  const auto rotations = rotations_of(seen);
  if (!rotations) return std::nullopt;
  PoseTrackerSetup setup = given;
  setup.body_from_station.rotation = rotations->first;
  std::vector<std::uint8_t> use(seen.size(), 1);
  for (int pass = 0; pass < 2; ++pass) {
    Vector3d offset;
    if (!fit_translations(seen, use, rotations->first, setup.body_from_station.translation, offset)) {
      return std::nullopt;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      setup.targets[target].offset.coordinate[k].value = offset[static_cast<Index>(k)];
    }
    const std::vector<double> apart = distances(setup, seen);
    const double most = kFarOff * median_of(apart);
    for (std::size_t k = 0; k < seen.size(); ++k) use[k] = apart[k] <= most ? 1 : 0;
  }
  return setup;
}

/// The orientation of every target that is estimated, the mean, and offsets that are open, the medians, for the station
/// as it stands.
void mount_targets(const std::vector<SeenTarget>& all, const std::vector<std::uint8_t>& use, bool offsets_too,
                   PoseTrackerSetup& setup) {
  for (std::size_t t = 0; t < setup.targets.size(); ++t) {
    PoseTrackerSetup::Target& target = setup.targets[t];
    Matrix3d turned = Matrix3d::Zero();
    std::array<std::vector<double>, 3> offset;
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (all[k].target != t || use[k] == 0) continue;
      const Matrix3d back = all[k].body.rotation.transpose();
      turned += back * setup.body_from_station.rotation * all[k].rotation;
      const Vector3d on_body = back * (setup.body_from_station * all[k].position - all[k].body.translation);
      for (std::size_t c = 0; c < 3; ++c) offset[c].push_back(on_body[static_cast<Index>(c)]);
    }
    if (offset[0].empty()) continue;
    if (target.estimate_rotation) target.rotation = rotation_from_correlation(turned);
    for (std::size_t k = 0; k < 3 && offsets_too; ++k) {
      SetupNumber& number = target.offset.coordinate[k];
      if (number.knowledge == Knowledge::open) number.value = median_of(offset[k]);
    }
  }
}

}  // namespace

std::vector<RigidTransform> seen_bodies(const Machine& machine, const ErrorSet& errors, const Instrument& instrument,
                                        const InstrumentReadings& readings) {
  std::vector<RigidTransform> result(readings.count());
  const std::vector<InstrumentItem>& items = instrument.items();
  for (std::size_t item = 0; item < items.size(); ++item) {
    std::vector<std::size_t> own;
    for (std::size_t k = 0; k < readings.count(); ++k) {
      if (readings.item[k] == item) own.push_back(k);
    }
    if (own.empty()) continue;
    std::vector<std::vector<double>> positions(machine.axes.size(), std::vector<double>(own.size()));
    std::vector<const double*> axis;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      for (std::size_t k = 0; k < own.size(); ++k) positions[i][k] = readings.poses.axis[i][own[k]];
      axis.push_back(positions[i].data());
    }
    const Vector3d start = items[item].from == Body::tool ? errors.tool_offset_error : Vector3d(Vector3d::Zero());
    std::vector<double> numbers(12 * own.size());
    RotationArrays rotation;
    double* origin[3];
    for (std::size_t i = 0; i < 3; ++i) {
      origin[i] = &numbers[(9 + i) * own.size()];
      std::fill_n(origin[i], own.size(), start[static_cast<Index>(i)]);
    }
    for (std::size_t i = 0; i < 9; ++i) rotation.r[i] = &numbers[i * own.size()];
    const ChainPlan plan(machine, errors, items[item].from, items[item].to);
    std::vector<double> states;
    std::vector<const double*> state;
    GivenStates(machine, errors).gather(readings.poses, own, states, state);
    plan.transform({axis, own.size(), state}, {origin[0], origin[1], origin[2]}, {origin[0], origin[1], origin[2]},
                   rotation);
    for (std::size_t k = 0; k < own.size(); ++k) {
      RigidTransform& body = result[own[k]];
      for (Index i = 0; i < 9; ++i) body.rotation(i / 3, i % 3) = rotation.r[i][k];
      body.translation = Vector3d(origin[0][k], origin[1][k], origin[2][k]);
      if (items[item].to == Body::tool) body.translation -= errors.tool_offset_error;
    }
  }
  return result;
}

PoseTrackerStart find_pose_tracker_start(const Machine& machine, const PoseTrackerSetup& given,
                                         const InstrumentReadings& readings) {
  PoseTrackerStart start{.setup = given, .fit = {.place = given.name, .readings = {}}, .messages = {}};
  const std::vector<SeenTarget> all = seen_targets(machine, given, readings);
  std::vector<Vector3d> measured, modelled;
  bool has_open = false;
  for (std::size_t k = 0; k < all.size(); ++k) {
    start.fit.readings.push_back(k);
    measured.push_back(all[k].position);
    modelled.push_back(modelled_point(given, all[k]));
    has_open |= has_open_offset(given.targets[all[k].target]);
  }
  start.fit.extent_mm = extent_of_points(modelled);
  std::vector<std::uint8_t> use(all.size(), 1);
  if (!given.estimate_pose) {
    start.fit.found = !all.empty();
    mount_targets(all, use, true, start.setup);
    return start;
  }
  RobustFitOptions options;
  options.collinear_extent = 3 * given.position_noise;
  const BestFitTransform fit = robust_best_fit_transform(measured, modelled, options);
  start.fit.found = fit.status == BestFitStatus::ok;
  start.fit.determined = start.fit.found || fit.status == BestFitStatus::no_consensus;
  if (start.fit.found || fit.status == BestFitStatus::collinear) {
    start.setup.body_from_station = fit.target_from_source;
    if (start.fit.found && fit.inliers.size() == use.size()) use = fit.inliers;
  }
  double least = start.fit.found ? median_of(distances(start.setup, all)) : std::numeric_limits<double>::infinity();
  bool together = false;
  for (std::size_t t = 0; t < given.targets.size(); ++t) {
    if (start.fit.found && !has_open_offset(given.targets[t])) continue;
    std::optional<PoseTrackerSetup> other = found_together(given, all, t);
    if (!other) continue;
    use.assign(all.size(), 1);
    mount_targets(all, use, true, *other);
    const double left = median_of(distances(*other, all));
    if (!(left < least)) continue;
    least = left;
    together = true;
    start.setup = std::move(*other);
    start.fit.found = start.fit.determined = true;
  }
  start.fit.rough = has_open && !together;
  mount_targets(all, use, false, start.setup);
  if (!start.fit.found) {
    start.messages.push_back(
        fmt::format("{}: the readings do not determine where it stands ({})", given.name,
                    fit.status == BestFitStatus::no_consensus     ? "no pose explains half of the positions"
                    : fit.status == BestFitStatus::too_few_points ? "there are fewer than three"
                                                                  : "all positions are on one line"));
  }
  return start;
}

}  // namespace abbe
