#include "five_instruments_ceres.h"

#include <ceres/normal_prior.h>
#include <ceres/rotation.h>

#include <array>
#include <cmath>

namespace abbe::benchmarks {
namespace {

using benchmark_case::FiveInstrumentsCase;
using benchmark_case::kAxisParameters;

constexpr std::size_t kAxes = 5;
enum class Kind { tracker, ball_bar, interferometer, r_test, tracking };
constexpr int rows_of(Kind kind) { return kind == Kind::ball_bar || kind == Kind::tracking ? 1 : 3; }

/// Error motions of one axis at one of its positions.
template <typename T>
struct AxisErrors {
  T shift[3], sine[3], cosine[3];

  /// @param coefficients  [6][functions]
  AxisErrors(const T* coefficients, const double* basis, int functions) {
    using std::cos;
    using std::sin;
    for (int component = 0; component < 6; ++component) {
      T sum = coefficients[component * functions] * basis[0];
      for (int k = 1; k < functions; ++k) sum += coefficients[component * functions + k] * basis[k];
      if (component < 3) {
        shift[component] = sum;
      } else {
        sine[component - 3] = sin(sum);
        cosine[component - 3] = cos(sum);
      }
    }
  }

  /// Rz Ry Rx in.
  template <typename In>
  void turn(const In in[3], T out[3]) const {
    const T y1 = cosine[0] * in[1] - sine[0] * in[2], z1 = sine[0] * in[1] + cosine[0] * in[2];
    const T x2 = cosine[1] * in[0] + sine[1] * z1;
    out[2] = cosine[1] * z1 - sine[1] * in[0];
    out[0] = cosine[2] * x2 - sine[2] * y1;
    out[1] = sine[2] * x2 + cosine[2] * y1;
  }
  /// (Rz Ry Rx)' v, in place.
  void turn_back(T v[3]) const {
    const T x1 = cosine[2] * v[0] + sine[2] * v[1], y1 = cosine[2] * v[1] - sine[2] * v[0];
    const T z2 = sine[1] * x1 + cosine[1] * v[2];
    v[0] = cosine[1] * x1 - sine[1] * v[2];
    v[1] = cosine[0] * y1 + sine[0] * z2;
    v[2] = cosine[0] * z2 - sine[0] * y1;
  }
};

/// One reading; basis functions, sines and cosines of the commands are computed once.
template <Kind kind>
class ReadingResidual {
 public:
  ReadingResidual(const FiveInstrumentsCase& data, std::size_t reading) : data_(data) {
    const PoseList& poses = kind == Kind::tracker ? data.tracked.poses : readings().poses;
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
      const Basis& of_axis = data.start.motions[axis * 6].basis;
      command_[axis] = poses.axis[axis][reading];
      of_axis.values(command_[axis], {}, {basis_[axis], of_axis.size()});
      functions_[axis] = static_cast<int>(of_axis.size());
      data.machine.axes[axis].direction.maxCoeff(&direction_[axis]);
      sine_[axis] = std::sin(command_[axis]);
      cosine_[axis] = std::cos(command_[axis]);
    }
    item_ = kind == Kind::tracker ? data.tracked.reflector[reading] : readings().item[reading];
    for (std::size_t row = 0; row < rows_of(kind); ++row) {
      measured_[row] = kind == Kind::tracker ? data.tracked.measured[row][reading] : readings().measured[row][reading];
    }
  }

  template <typename T>
  bool operator()(const T* c, const T* a, const T* y, const T* x, const T* z, const T* setup, T* residuals) const {
    return evaluate<T>({c, a, y, x, z}, setup, nullptr, residuals);
  }
  template <typename T>
  bool operator()(const T* c, const T* a, const T* y, const T* x, const T* z, const T* setup, const T* more,
                  T* residuals) const {
    return evaluate<T>({c, a, y, x, z}, setup, more, residuals);
  }
  template <typename T>
  bool operator()(T const* const* blocks, T* residuals) const {
    return evaluate<T>({blocks[0], blocks[1], blocks[2], blocks[3], blocks[4]}, blocks[5],
                       kind == Kind::tracking ? blocks[6] : nullptr, residuals);
  }

 private:
  template <typename T>
  using Errors = std::array<AxisErrors<T>, kAxes>;

  static constexpr std::size_t kInstrument = kind == Kind::tracker ? 0 : static_cast<std::size_t>(kind) - 1;
  const InstrumentReadings& readings() const { return data_.readings[kInstrument]; }
  /// A number of the set-up that is not estimated.
  double known(std::size_t quantity) const {
    const Instrument& instrument = *data_.instruments[kInstrument];
    return instrument.quantities()[instrument.items()[item_].quantities[quantity]].value;
  }

  template <typename T>
  void turn_by_command(std::size_t axis, T v[3]) const {
    const Eigen::Index i = (direction_[axis] + 1) % 3, j = (direction_[axis] + 2) % 3;
    const T turned = cosine_[axis] * v[i] - sine_[axis] * v[j];
    v[j] = sine_[axis] * v[i] + cosine_[axis] * v[j];
    v[i] = turned;
  }

  /// A point of the tool, from its gauge point, in the frame of the workpiece (which is the machine's at zero).
  /// Tool side Trans(q u) E; workpiece side, all primed, ( Trans(-q u) E )^-1 and ( E Rot(u, -q) )^-1.
  template <typename T>
  void see_point(const Errors<T>& errors, const double own[3], T p[3]) const {
    const Machine& machine = data_.machine;
    const double start[3] = {own[0] + machine.tool_reference[0], own[1] + machine.tool_reference[1],
                             own[2] + machine.tool_reference[2]};
    for (std::size_t axis = kAxes; axis-- > 0;) {
      const Eigen::Vector3d& centre = machine.axes[axis].point;
      if (axis >= 3) {
        T turned[3];
        if (axis + 1 == kAxes) {
          errors[axis].turn(start, turned);
        } else {
          errors[axis].turn(p, turned);
        }
        for (int i = 0; i < 3; ++i) p[i] = turned[i] + errors[axis].shift[i];
        p[direction_[axis]] += command_[axis];
      } else {
        if (machine.axes[axis].kind == AxisKind::linear) p[direction_[axis]] += command_[axis];
        for (int i = 0; i < 3; ++i) p[i] -= errors[axis].shift[i] + centre[i];
        errors[axis].turn_back(p);
        if (machine.axes[axis].kind == AxisKind::rotary) turn_by_command(axis, p);
        for (int i = 0; i < 3; ++i) p[i] += centre[i];
      }
    }
  }

  /// A direction of the tool in the frame of the workpiece.
  template <typename T>
  void see_direction(const Errors<T>& errors, const Eigen::Vector3d& own, T v[3]) const {
    errors[4].turn(own.data(), v);
    T turned[3];
    errors[3].turn(v, turned);
    for (int i = 0; i < 3; ++i) v[i] = turned[i];
    for (std::size_t axis = 3; axis-- > 0;) {
      errors[axis].turn_back(v);
      if (data_.machine.axes[axis].kind == AxisKind::rotary) turn_by_command(axis, v);
    }
  }

  template <typename T>
  static T distance(const T p[3], const T q[3]) {
    using std::sqrt;
    const T d[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
    return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  }

  template <typename T>
  bool evaluate(const std::array<const T*, kAxes>& axes, const T* setup, const T* more, T* residuals) const {
    using std::asin;
    const Errors<T> errors = {
        AxisErrors<T>(axes[0], basis_[0], functions_[0]), AxisErrors<T>(axes[1], basis_[1], functions_[1]),
        AxisErrors<T>(axes[2], basis_[2], functions_[2]), AxisErrors<T>(axes[3], basis_[3], functions_[3]),
        AxisErrors<T>(axes[4], basis_[4], functions_[4])};
    T p[3];
    if constexpr (kind == Kind::tracker) {
      const TrackerSetup& tracker = data_.tracker;
      see_point<T>(errors, tracker.reflectors[item_].offset.data(), p);
      for (int i = 0; i < 3; ++i) p[i] -= setup[i];
      const T back[3] = {-setup[3], -setup[4], -setup[5]};
      T q[3];
      ceres::AngleAxisRotatePoint(back, p, q);
      const Eigen::Matrix3d& rotation = tracker.stations[0].body_from_tracker.rotation;
      for (int i = 0; i < 3; ++i) {
        const T seen = rotation(0, i) * q[0] + rotation(1, i) * q[1] + rotation(2, i) * q[2];
        residuals[i] = (measured_[i] - seen) / FiveInstrumentsCase::kTrackerNoise;
      }
      return true;
    } else {
      const double own[3] = {known(0), known(1), known(2)};
      see_point<T>(errors, own, p);
    }
    if constexpr (kind == Kind::ball_bar) {
      residuals[0] = (measured_[0] - distance<T>(p, setup + 1) - setup[0]) / FiveInstrumentsCase::kBarNoise;
    } else if constexpr (kind == Kind::interferometer) {
      const Eigen::Vector3d x = data_.machine.axes[item_ + 2].direction;
      const Eigen::Vector3d up = item_ == 2 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ();
      const Eigen::Vector3d y = up.cross(x), z = x.cross(y);
      T carried_y[3], carried_z[3];
      see_direction<T>(errors, y, carried_y);
      see_direction<T>(errors, z, carried_z);
      const int along = static_cast<int>(direction_[item_ + 2]);
      residuals[0] = (measured_[0] - p[along] - setup[0]) / FiveInstrumentsCase::kLengthNoise;
      residuals[1] = (measured_[1] - asin(carried_z[along]) - setup[1]) / FiveInstrumentsCase::kAngleNoise;
      residuals[2] = (measured_[2] + asin(carried_y[along]) - setup[2]) / FiveInstrumentsCase::kAngleNoise;
    } else if constexpr (kind == Kind::r_test) {
      for (int i = 0; i < 3; ++i) p[i] -= setup[i];
      for (int i = 0; i < 3; ++i) {
        const Eigen::Vector3d& d = data_.probe_directions[static_cast<std::size_t>(i)];
        residuals[i] = (measured_[i] - (d[0] * p[0] + d[1] * p[1] + d[2] * p[2])) / FiveInstrumentsCase::kProbeNoise;
      }
    } else if constexpr (kind == Kind::tracking) {
      residuals[0] = (measured_[0] - distance<T>(p, setup) + more[0]) / FiveInstrumentsCase::kTrackingNoise;
    }
    return true;
  }

  const FiveInstrumentsCase& data_;
  double basis_[kAxes][5], command_[kAxes], sine_[kAxes], cosine_[kAxes];
  int functions_[kAxes];
  Eigen::Index direction_[kAxes];
  double measured_[3] = {};
  std::size_t item_ = 0;
};

template <Kind kind, int... kSetup>
ceres::CostFunction* cost_of(const FiveInstrumentsCase& data, std::size_t reading, CeresDerivatives derivatives) {
  auto* residual = new ReadingResidual<kind>(data, reading);
  if (derivatives == CeresDerivatives::whole) {
    return new ceres::AutoDiffCostFunction<ReadingResidual<kind>, rows_of(kind), kAxisParameters[0], kAxisParameters[1],
                                           kAxisParameters[2], kAxisParameters[3], kAxisParameters[4], kSetup...>(
        residual);
  }
  auto* cost = new ceres::DynamicAutoDiffCostFunction<ReadingResidual<kind>, 4>(residual);
  for (const int size : kAxisParameters) cost->AddParameterBlock(size);
  for (const int size : {kSetup...}) cost->AddParameterBlock(size);
  cost->SetNumResiduals(rows_of(kind));
  return cost;
}

}  // namespace

CeresIdentification::CeresIdentification(const FiveInstrumentsCase& data, const Problem& problem,
                                         CeresDerivatives derivatives)
    : x_(present_values(problem)) {
  // Axes, tracker, ball bar, zeros of three runs, nest, two stations, two dead paths: the order of the estimates.
  sizes_.assign(kAxisParameters.begin(), kAxisParameters.end());
  sizes_.insert(sizes_.end(), {6, 4, 3, 3, 3, 3, 3, 3, 1, 1});
  double* next = x_.data();
  for (const std::size_t size : sizes_) {
    blocks_.push_back(next);
    ceres_.AddParameterBlock(next, static_cast<int>(size));
    next += size;
  }
  const auto add = [&](ceres::CostFunction* cost, std::initializer_list<std::size_t> setup) {
    std::vector<double*> seen(blocks_.begin(), blocks_.begin() + kAxes);
    for (const std::size_t block : setup) seen.push_back(blocks_[block]);
    readings_.push_back(ceres_.AddResidualBlock(cost, nullptr, seen));
  };
  for (std::size_t k = 0; k < data.tracked.count(); ++k) add(cost_of<Kind::tracker, 6>(data, k, derivatives), {5});
  for (std::size_t k = 0; k < data.readings[0].count(); ++k) {
    add(cost_of<Kind::ball_bar, 4>(data, k, derivatives), {6});
  }
  for (std::size_t k = 0; k < data.readings[1].count(); ++k) {
    add(cost_of<Kind::interferometer, 3>(data, k, derivatives), {7U + data.readings[1].item[k]});
  }
  for (std::size_t k = 0; k < data.readings[2].count(); ++k) {
    add(cost_of<Kind::r_test, 3>(data, k, derivatives), {10});
  }
  for (std::size_t k = 0; k < data.readings[3].count(); ++k) {
    const std::size_t run = data.readings[3].item[k];
    add(cost_of<Kind::tracking, 3, 1>(data, k, derivatives), {11 + run, 13 + run});
  }
  for (std::size_t block = 0; block < blocks_.size(); ++block) add_prior(problem, block);
}

void CeresIdentification::add_prior(const Problem& problem, std::size_t block) {
  const std::size_t first = static_cast<std::size_t>(blocks_[block] - x_.data());
  const Eigen::Index size = static_cast<Eigen::Index>(sizes_[block]);
  Eigen::VectorXd value = Eigen::VectorXd::Zero(size), weight = Eigen::VectorXd::Zero(size);
  for (const Prior& prior : problem.priors) {
    const std::size_t at = find_estimated(problem, prior.parameter);
    if (at < first || at >= first + sizes_[block]) continue;
    value[static_cast<Eigen::Index>(at - first)] = prior.value;
    weight[static_cast<Eigen::Index>(at - first)] = 1 / prior.standard_uncertainty;
  }
  if (weight.isZero(0)) return;
  ceres_.AddResidualBlock(new ceres::NormalPrior(weight.asDiagonal(), value), nullptr, blocks_[block]);
}

std::vector<double> CeresIdentification::residuals() {
  ceres::Problem::EvaluateOptions options;
  options.residual_blocks = readings_;
  std::vector<double> result;
  ceres_.Evaluate(options, nullptr, &result, nullptr, nullptr);
  return result;
}

}  // namespace abbe::benchmarks
