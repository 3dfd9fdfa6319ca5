#include "abbe/identify/linkage/linkage_errors.h"

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/errors/calibrated_machine.h"
#include "abbe/machine/machines_for_test.h"

namespace abbe {
namespace {

Machine engraver(LinkageConvention convention) {
  return test::yin_engraver(convention == LinkageConvention::table_moves ? 'U' : 'P');
}

TEST(LinkageErrors, MakeTheNominalMachineTheOneThatWasFound) {
  const SwingHeadLinkage found{240.8, 209.4, -0.25, -0.2, {-197.2, 25.35, -529.1}};
  for (const LinkageConvention convention : {LinkageConvention::table_moves, LinkageConvention::head_moves}) {
    const Machine machine = engraver(convention);
    EXPECT_EQ(linkage_convention_of(machine), convention);
    const LinkageErrors errors = linkage_errors(machine, convention, found, Eigen::MatrixXd::Identity(7, 7));
    const Machine calibrated = calibrated_machine(machine, errors.errors).machine;
    for (std::size_t i = 0; i < SwingHeadLinkage::kCount; ++i) {
      EXPECT_NEAR(linkage_of(calibrated, convention).values()[i], found.values()[i], 1e-12) << linkage_name(i);
    }
    EXPECT_EQ(parameter_names(machine, errors.errors),
              (std::vector<std::string>{"EX0C1", "EY0C1", "EY0A", "EZ0A", "tool_X", "tool_Y", "tool_Z"}));
  }
}

TEST(LinkageErrors, CovarianceIsThatOfTheLinkageByFiniteDifferences) {
  const Machine machine = engraver(LinkageConvention::table_moves);
  const SwingHeadLinkage found{240.8, 209.4, -0.25, -0.2, {-197.2, 25.35, -529.1}};
  Eigen::MatrixXd root(7, 7);
  for (Eigen::Index i = 0; i < 49; ++i) root(i / 7, i % 7) = 1e-3 * std::sin(static_cast<double>(3 * i + 1));
  const Eigen::MatrixXd covariance = root * root.transpose();
  const auto errors_at = [&](std::size_t parameter, double step) {
    auto values = found.values();
    values[parameter] += step;
    const std::vector<double> all =
        linkage_errors(machine, LinkageConvention::table_moves, SwingHeadLinkage::of(values), covariance)
            .errors.parameters();
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size())));
  };
  Eigen::MatrixXd slopes(7, 7);
  for (std::size_t p = 0; p < 7; ++p)
    slopes.col(static_cast<Eigen::Index>(p)) = (errors_at(p, 1) - errors_at(p, -1)) / 2;
  const LinkageErrors errors = linkage_errors(machine, LinkageConvention::table_moves, found, covariance);
  EXPECT_LT((errors.covariance - slopes * covariance * slopes.transpose()).norm(), 1e-12);
  EXPECT_NEAR(errors.errors.locations[2].standard_uncertainty, std::sqrt(errors.covariance(2, 2)), 1e-15);
}

TEST(SwingHeadLinkage, AToolOffsetErrorAlongTheAxisOfAIsOneOfRC1) {
  const Machine machine = engraver(LinkageConvention::table_moves);
  ErrorSet errors;
  errors.tool_offset_error = {0.025, 0, 0};
  const SwingHeadLinkage found =
      linkage_of(calibrated_machine(machine, errors).machine, LinkageConvention::table_moves);
  EXPECT_NEAR(found.a_to_c1, 209.476 + 0.025, 1e-12);
}

}  // namespace
}  // namespace abbe
