// Identification of 60 parameters of a machine w C' X' b Z t from laser tracker readings: this project against
// Ceres with automatic differentiation and Ceres with this project's analytic Jacobian. Same readings, start, tolerance
// and threads; dense normal Cholesky; covariance included. Then memory at 1,000,000 readings, and a Monte Carlo run.
//
//   identification [--avx2] [--quick]     prints one line per figure; exit code 1 if a target is missed
#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <cstdio>
#include <cstring>
#include <string>

#include "abbe/identify/trust/monte_carlo.h"
#include "ceres_solution.h"
#include "identification_case.h"
#include "instruction_set.h"

namespace {

using abbe::benchmark_case::XcfzCase;
using namespace abbe::benchmarks;
constexpr double kSigma = 0.010;  // mm

/// One reading as a user of Ceres writes it: 4x4 chain with error matrices, basis values computed once.
struct ChainResidual {
  const XcfzCase& data;
  std::size_t reading;
  std::vector<double> basis[3];  // values of the basis functions of C, X, Z at this reading

  explicit ChainResidual(const XcfzCase& d, std::size_t r) : data(d), reading(r) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const abbe::Basis& b = d.truth.motions[axis * 6].basis;
      basis[axis].resize(b.size());
      b.values(d.readings.poses.axis[axis][r], {}, basis[axis]);
    }
  }

  template <typename T>
  static void rotate_xyz(const T& a, const T& b, const T& c, const T in[3], T out[3]) {
    using std::cos;
    using std::sin;
    const T ca = cos(a), sa = sin(a), cb = cos(b), sb = sin(b), cc = cos(c), sc = sin(c);
    const T y1 = ca * in[1] - sa * in[2], z1 = sa * in[1] + ca * in[2];
    const T x2 = cb * in[0] + sb * z1, z2 = -sb * in[0] + cb * z1;
    out[0] = cc * x2 - sc * y1;
    out[1] = sc * x2 + cc * y1;
    out[2] = z2;
  }

  // Inverse of p -> Rz Ry Rx p + t.
  template <typename T>
  static void back(const T e[6], const T in[3], T out[3]) {
    using std::cos;
    using std::sin;
    const T ca = cos(e[3]), sa = sin(e[3]), cb = cos(e[4]), sb = sin(e[4]), cc = cos(e[5]), sc = sin(e[5]);
    const T x = in[0] - e[0], y = in[1] - e[1], z = in[2] - e[2];
    const T x1 = cc * x + sc * y, y1 = -sc * x + cc * y;
    const T x2 = cb * x1 - sb * z, z2 = sb * x1 + cb * z;
    out[0] = x2;
    out[1] = ca * y1 + sa * z2;
    out[2] = -sa * y1 + ca * z2;
  }

  template <typename T>
  bool operator()(const T* const parameters, T* residuals) const {
    T errors[3][6];
    std::size_t next = 0, estimated = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t component = 0; component < 6; ++component) {
        errors[axis][component] = T(0);
        for (std::size_t k = 0; k < basis[axis].size(); ++k, ++next)
          if (estimated < data.parameters.size() && data.parameters[estimated] == next)
            errors[axis][component] += parameters[estimated++] * basis[axis][k];
      }
    const abbe::Machine& machine = data.machine;
    const Eigen::Vector3d& offset = data.setup.reflectors[data.readings.reflector[reading]].offset;
    const double c = data.readings.poses.axis[0][reading], x = data.readings.poses.axis[1][reading];
    const double z = data.readings.poses.axis[2][reading];
    // Z: Trans(reference + q u) E Trans(-reference); the reflector counts from the reference point.
    const T tool[3] = {T(offset[0]), T(offset[1]), T(offset[2])};
    T p[3], q[3];
    rotate_xyz(errors[2][3], errors[2][4], errors[2][5], tool, p);
    for (int i = 0; i < 3; ++i) p[i] += errors[2][i] + machine.tool_reference[i];
    p[2] += z;
    // X carries the table the other way: p = (-x) + E p_x.
    p[0] += x;
    back(errors[1], p, q);
    // C: p_x = centre + E Rz(-c) (p_c - centre).
    for (int i = 0; i < 3; ++i) q[i] -= machine.axes[0].point[i];
    back(errors[0], q, p);
    const double cc = std::cos(c), sc = std::sin(c);
    q[0] = cc * p[0] - sc * p[1];
    q[1] = sc * p[0] + cc * p[1];
    q[2] = p[2];
    // Tracker: x = (exp(w) R)^T (p - t).
    const T* pose = parameters + data.parameters.size();
    for (int i = 0; i < 3; ++i) q[i] -= pose[i];
    const T turn[3] = {-pose[3], -pose[4], -pose[5]};
    ceres::AngleAxisRotatePoint(turn, q, p);
    const Eigen::Matrix3d& rotation = data.setup.stations[0].body_from_tracker.rotation;
    for (int i = 0; i < 3; ++i) {
      const T seen = rotation(0, i) * p[0] + rotation(1, i) * p[1] + rotation(2, i) * p[2];
      residuals[i] = (data.readings.measured[static_cast<std::size_t>(i)][reading] - seen) / kSigma;
    }
    return true;
  }
};

/// Our residuals and Jacobian, block by block, for Ceres.
class AnalyticBlock : public ceres::CostFunction {
 public:
  AnalyticBlock(const abbe::Observations& observations, const std::vector<std::size_t>& machine, std::size_t first,
                std::size_t count)
      : observations_(observations), machine_(machine), first_(first), count_(count) {
    mutable_parameter_block_sizes()->push_back(static_cast<int>(machine.size() + 6));
    set_num_residuals(static_cast<int>(3 * count));
  }
  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    const std::size_t length = 3 * count_, columns = machine_.size() + 6;
    std::vector<double> jacobian(jacobians && jacobians[0] ? length * columns : 0);
    observations_.evaluate(first_, count_, machine_, setup_, residuals, jacobian.empty() ? nullptr : jacobian.data(),
                           length);
    for (std::size_t c = 0; c < columns && !jacobian.empty(); ++c)
      for (std::size_t k = 0; k < length; ++k) jacobians[0][k * columns + c] = -jacobian[c * length + k];
    return true;
  }

 private:
  const abbe::Observations& observations_;
  const std::vector<std::size_t>& machine_;
  std::vector<std::size_t> setup_ = {0, 1, 2, 3, 4, 5};
  std::size_t first_, count_;
};

/// Moves the observations to Ceres's present point before an evaluation.
class MoveObservations : public ceres::EvaluationCallback {
 public:
  MoveObservations(const abbe::Problem& problem, const Eigen::VectorXd& x) : problem_(problem), x_(x) {}
  void PrepareForEvaluation(bool, bool) override { abbe::set_observations(problem_, x_); }

 private:
  const abbe::Problem& problem_;
  const Eigen::VectorXd& x_;
};

template <int N>
CeresSolution solve_with_ceres(const XcfzCase& data, const abbe::Problem& problem, abbe::Observations& observed,
                               bool analytic) {
  Eigen::VectorXd x = abbe::present_values(problem);
  MoveObservations move(problem, x);
  ceres::Problem::Options problem_options;
  if (analytic) problem_options.evaluation_callback = &move;
  ceres::Problem ceres_problem(problem_options);
  const std::size_t count = observed.reading_count();
  if (analytic)
    for (std::size_t first = 0; first < count; first += 128)
      ceres_problem.AddResidualBlock(
          new AnalyticBlock(observed, problem.machine_parameters, first, std::min<std::size_t>(128, count - first)),
          nullptr, x.data());
  else
    for (std::size_t i = 0; i < count; ++i)
      ceres_problem.AddResidualBlock(new ceres::AutoDiffCostFunction<ChainResidual, 3, N>(new ChainResidual(data, i)),
                                     nullptr, x.data());
  return solve_with_covariance(ceres_problem, x, {x.data()});
}

bool compare(std::size_t count, bool with_ceres) {
  const XcfzCase data(count);
  constexpr int kParameters = BENCHMARK_PARAMETERS;
  std::unique_ptr<abbe::TrackerObservations> observed = data.observations();
  if (data.parameters.size() + 6 != kParameters) {
    std::printf("parameters %zu\n", data.parameters.size() + 6);
    return false;
  }
  abbe::Identification ours;
  double best = 1e9;
  for (int repetition = 0; repetition < 15; ++repetition) {
    observed = data.observations();
    abbe::Problem problem = data.problem(*observed);
    const double start = seconds();
    ours = abbe::identify(problem, our_options());
    best = std::min(best, seconds() - start);
  }
  std::printf("%zu readings, %d parameters: %s, %zu iterations, chi-square/dof %.4f, condition %.0f\n", count,
              kParameters, ours.message.c_str(), ours.history.size(), ours.statistics.variance_factor,
              ours.statistics.observability.condition);
  std::printf("  this project                                    %10.2f ms\n", 1e3 * best);
  if (!with_ceres) return ours.status == abbe::IdentifyStatus::converged;
  bool good = ours.status == abbe::IdentifyStatus::converged;
  for (const bool analytic : {false, true}) {
    observed = data.observations();
    const abbe::Problem problem = data.problem(*observed);
    CeresSolution theirs;
    double ceres_best = 1e9;
    for (int repetition = 0; repetition < (count > 50000 ? 1 : 4); ++repetition) {
      observed = data.observations();
      abbe::Problem fresh = data.problem(*observed);
      theirs = solve_with_ceres<kParameters>(data, fresh, *observed, analytic);
      ceres_best = std::min(ceres_best, theirs.time);
    }
    std::printf("  Ceres, %-28s             %10.2f ms, %d iterations\n",
                analytic ? "our analytic Jacobian" : "automatic differentiation", 1e3 * ceres_best, theirs.iterations);
    const double difference =
        (theirs.x - ours.estimates).cwiseQuotient(ours.standard_uncertainties).cwiseAbs().maxCoeff();
    const double spread = (theirs.uncertainty.cwiseQuotient(ours.standard_uncertainties).array() - 1).abs().maxCoeff();
    good &= check("largest difference of estimates, standard uncertainties", difference, difference < 1e-2);
    good &= check("largest relative difference of uncertainties", spread, spread < 1e-4);
    const double ratio = ceres_best / best, target = analytic ? 10 : 40;
    good &= check(analytic ? "times faster (target 10)" : "times faster (target 40)", ratio, ratio >= target);
  }
  return good;
}

}  // namespace

int main(int count, char** arguments) {
  take_avx2(count, arguments);
  const bool quick = count > 1 && std::strcmp(arguments[1], "--quick") == 0;
  bool good = compare(10000, true);
  if (!quick) good &= compare(100000, true);
  {
    const XcfzCase data(1000);
    const std::unique_ptr<abbe::TrackerObservations> observed = data.observations();
    abbe::Problem problem = data.problem(*observed);
    const abbe::Identification solution = abbe::identify(problem, our_options());
    abbe::MonteCarloOptions options;
    options.samples = 10000;
    options.threads = kThreads;
    const double start = seconds();
    const abbe::MonteCarloResult simulated = abbe::monte_carlo(problem, solution, options);
    const double time = seconds() - start;
    double worst = 0;
    for (Eigen::Index i = 0; i < solution.estimates.size(); ++i)
      worst = std::max(worst, std::abs(std::sqrt(simulated.covariance(i, i)) / solution.standard_uncertainties[i] - 1));
    std::printf("Monte Carlo, 10,000 identifications of 1,000 readings\n");
    good &= check("seconds (target 2)", time, time < 2);
    good &= check("largest relative difference of uncertainties", worst, worst < 0.04);
  }
  return good ? 0 : 1;
}
