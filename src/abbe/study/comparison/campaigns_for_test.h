#pragma once

// Campaigns of the three-axis mill for tests.
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "abbe/errors/random_stream.h"
#include "abbe/errors/stated_uncertainty.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/study/comparison/compared_campaigns.h"
#include "abbe/verify/covariance_root.h"

namespace abbe {

/// The mill with errors in length and angle and of several orders, their covariance with correlations of 0.3
/// throughout.
inline IdentifiedCampaign mill_campaign(const std::string& name) {
  const std::string examples = ABBE_SOURCE_DIR "/examples/";
  IdentifiedCampaign campaign;
  campaign.name = name;
  campaign.errors_file = name + ".errors.toml";
  campaign.machine = read_machine(examples + "machines/three-axis-mill.machine.toml");
  campaign.errors = read_errors(examples + "compensate/mill.errors.toml", campaign.machine);
  const std::vector<double> u = stated_uncertainties(campaign.errors.errors);
  const Eigen::Map<const Eigen::VectorXd> values(u.data(), static_cast<Eigen::Index>(u.size()));
  campaign.errors.covariance = 0.3 * values * values.transpose();
  campaign.errors.covariance.diagonal() = values.cwiseAbs2();
  return campaign;
}

/// Index of the first parameter of an error motion.
inline std::size_t first_parameter(const ErrorSet& errors, std::size_t axis, Component component) {
  std::size_t next = 0;
  for (const ErrorMotion& motion : errors.motions) {
    if (motion.axis == axis && motion.component == component) return next;
    next += motion.coefficients.size();
  }
  return next;
}

/// What another identification with the same covariance could have found.
inline IdentifiedCampaign drawn(IdentifiedCampaign campaign, std::uint64_t seed, std::uint64_t stream) {
  RandomStream random(seed, stream);
  const Eigen::MatrixXd root = covariance_root(campaign.errors.covariance);
  Eigen::VectorXd normal(root.cols());
  for (double& value : normal) value = random.normal();
  std::vector<double> parameters = campaign.errors.errors.parameters();
  const Eigen::VectorXd noise = root * normal;
  for (std::size_t i = 0; i < parameters.size(); ++i) parameters[i] += noise[static_cast<Eigen::Index>(i)];
  campaign.errors.errors.set_parameters(parameters);
  return campaign;
}

inline CompareRequest request_of(std::vector<IdentifiedCampaign> campaigns) {
  CompareRequest request;
  request.campaigns = std::move(campaigns);
  return request;
}

inline const ComparedError* find_error(const ComparedPair& pair, const std::string& name) {
  for (const ComparedError& error : pair.errors) {
    if (error.name == name) return &error;
  }
  return nullptr;
}

}  // namespace abbe
