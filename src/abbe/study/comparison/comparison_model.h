#pragma once

// Internal to study: two campaigns in one set of parameters.
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "abbe/study/comparison/compared_campaigns.h"

namespace abbe {

/// Typical errors of a machine, which make mm and rad comparable.
inline constexpr double kTypicalErrorLength = 0.01, kTypicalErrorAngle = 5e-5;
/// Descriptions of one machine agree to this, mm or in directions.
inline constexpr double kSameGeometry = 1e-6;

/// An error of either campaign, and where its parameters are in the model.
struct ModelledError {
  enum class Kind { motion, location, reversal, tool_offset };
  Kind kind = Kind::motion;
  std::size_t axis = 0;
  Component component = Component::X;
  std::size_t state = kNoState;      ///< of motions and locations; index into the states of the model's machine
  Eigen::Index first = 0, size = 1;  ///< parameters
  std::array<bool, 2> is_in{};       ///< whether the files have it
  double from = 0, to = 0;           ///< of motions: range that both know, or the one that has it, mm or rad
  std::array<double, 2> beyond{};    ///< of motions: largest amount of what the model does not describe, mm or rad

  bool is_angle(const Machine& machine) const;
  std::string name(const Machine& machine) const;
  std::string words(const Machine& machine) const;
};

/// Errors of a campaign as parameters of the model.
struct CampaignInModel {
  Eigen::VectorXd values;      ///< [m], mm or rad
  Eigen::MatrixXd covariance;  ///< [m, m]; 0 x 0: not stated
};

/// What both campaigns describe.
///
/// An error motion has the functions of the campaign that has fewer of them, over the range that both know. The
/// function of the other campaign is replaced by the nearest one (least squares over that range); values and covariance
/// follow by the same linear map. So a shape that only one campaign could describe is not taken for a change.
///
/// Terms with a state are an error of their own, per unit of the factor of the state.
///
/// An error that a file does not have is zero there without variance, as one that a convention sets. It can do what
/// others do: a squareness that is in one file may be a slope in the other. bring_into_one_gauge() finds that out.
struct ComparisonModel {
  Machine machine;                  ///< with the travel that both have
  ErrorSet errors;                  ///< structure; all values are zero
  std::vector<ModelledError> list;  ///< in the order of the parameters
  std::array<CampaignInModel, 2> campaigns;
  std::vector<std::string> apart;  ///< names of motions without a range in common
  bool tools_differ = false;       ///< the functional points are others: the tool offset error is left out

  /// The terms of an error motion.
  std::vector<ErrorMotion> terms(const ModelledError& error) const;
};

/// @param machine  of both, as common_machine() gives it
ComparisonModel comparison_model(const Machine& machine, const IdentifiedCampaign& first,
                                 const IdentifiedCampaign& second);

/// The machine of all campaigns, with the travel that they have in common.
/// @throws InputError if chains, axes or orders of composition differ, or an axis has no travel in common
Machine common_machine(const std::vector<IdentifiedCampaign>& campaigns);

/// The same numbers as a list.
std::vector<double> as_list(const Eigen::VectorXd& values);

/// Functions of the terms of an error motion side by side, [positions, functions]; linear in the coefficients, or their
/// derivative by them (monotone tables).
Eigen::MatrixXd sampled_functions(const std::vector<ErrorMotion>& terms, const std::vector<double>& positions);

}  // namespace abbe
