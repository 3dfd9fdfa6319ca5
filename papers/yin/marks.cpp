#include "yin/marks.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "abbe/errors/calibrated_machine.h"
#include "abbe/errors/random_stream.h"
#include "abbe/formats/study/study_file.h"
#include "abbe/identify/trust/prediction.h"
#include "abbe/study/study_steps.h"
#include "shared_file.h"

namespace abbe {
namespace {

using Matrix7 = Eigen::Matrix<double, SwingHeadLinkage::kCount, SwingHeadLinkage::kCount>;
constexpr LinkageConvention kTableMoves = LinkageConvention::table_moves;

SwingHeadLinkage linkage_with(const Machine& machine, const ErrorSet& errors) {
  return linkage_of(calibrated_machine(machine, errors).machine, kTableMoves);
}

/// d(linkage)/d(errors): calibration moves the machine's points, so differences are exact.
Eigen::MatrixXd linkage_by_errors(const Machine& machine, ErrorSet errors) {
  const std::vector<double> at = errors.parameters();
  Eigen::MatrixXd result(SwingHeadLinkage::kCount, static_cast<Eigen::Index>(at.size()));
  constexpr double kStep = 0.01;  // mm
  for (std::size_t p = 0; p < at.size(); ++p) {
    std::array<double, SwingHeadLinkage::kCount> values[2];
    for (const int side : {0, 1}) {
      std::vector<double> moved = at;
      moved[p] += side == 0 ? kStep : -kStep;
      errors.set_parameters(moved);
      values[side] = linkage_with(machine, errors).values();
    }
    for (std::size_t k = 0; k < SwingHeadLinkage::kCount; ++k) {
      result(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(p)) = (values[0][k] - values[1][k]) / (2 * kStep);
    }
  }
  return result;
}

}  // namespace

double YinJointFit::standard_uncertainty(std::size_t parameter) const {
  const auto i = static_cast<Eigen::Index>(parameter);
  return std::sqrt(std::max(0.0, covariance(i, i)));
}

double focus_uncertainty(const SwingHeadLinkage& linkage, const Matrix7& covariance) {
  constexpr int kPoses = 500;
  RandomStream random(11);
  double sum = 0;
  for (int i = 0; i < kPoses; ++i) {
    SwingHeadCommand c;
    c.a = random.uniform(-std::numbers::pi / 2, std::numbers::pi / 2);
    c.c1 = random.uniform(-std::numbers::pi, std::numbers::pi);
    // The focus is linear in the parameters.
    Eigen::Matrix<double, 3, SwingHeadLinkage::kCount> by_parameter;
    const Eigen::Vector3d here = swing_head_focus(linkage, kTableMoves, c);
    for (std::size_t k = 0; k < SwingHeadLinkage::kCount; ++k) {
      auto values = linkage.values();
      values[k] += 1;
      by_parameter.col(static_cast<Eigen::Index>(k)) =
          swing_head_focus(SwingHeadLinkage::of(values), kTableMoves, c) - here;
    }
    sum += (by_parameter * covariance * by_parameter.transpose()).trace() / kPoses;
  }
  return std::sqrt(sum);
}

YinJointFit yin_joint_fit(const LinkageEvaluation& steps) {
  const Study study = read_study(shared_file("examples/laser_engraver/marks.study.toml"));
  StudyResult study_result;
  study_result.campaign = gather_readings(study);
  identify_study(study, study_result);
  const Identification& identified = study_result.identification;
  YinJointFit result;
  result.converged = study_result.usable();
  result.message = identified.message;
  if (!result.converged) return result;
  result.readings = study_result.campaign.reading_count();
  result.chi_square = identified.statistics.chi_square;
  result.degrees_of_freedom = static_cast<long>(identified.statistics.degrees_of_freedom);
  result.truth = linkage_with(study.machine, *study_result.campaign.truth);
  result.found = linkage_with(study.machine, identified.errors);
  const Eigen::MatrixXd by_errors = linkage_by_errors(study.machine, identified.errors);
  result.covariance =
      by_errors * machine_covariance(identified, identified.errors.parameter_count()) * by_errors.transpose();
  result.focus = focus_uncertainty(result.found, result.covariance);
  result.focus_by_steps = focus_uncertainty(steps.linkage, steps.covariance);
  result.focus_without_correlations =
      focus_uncertainty(steps.linkage, Matrix7(steps.covariance.diagonal().asDiagonal()));
  return result;
}

}  // namespace abbe
