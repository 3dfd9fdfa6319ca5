#include "abbe/identify/linkage/linkage_errors.h"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace abbe {

LinkageErrors linkage_errors(const Machine& machine, LinkageConvention convention, const SwingHeadLinkage& found,
                             const Eigen::MatrixXd& covariance) {
  const auto nominal = linkage_of(machine, convention).values(), values = found.values();
  Eigen::Matrix<double, SwingHeadLinkage::kCount, 1> change;
  for (std::size_t i = 0; i < values.size(); ++i) change[static_cast<Eigen::Index>(i)] = values[i] - nominal[i];
  const double s = convention == LinkageConvention::table_moves ? -1.0 : 1.0;
  enum : Eigen::Index { kRA, kRC1, kLtA, kLAC1, kX0, kY0, kZ0 };
  Eigen::Matrix<double, SwingHeadLinkage::kCount, SwingHeadLinkage::kCount> by_linkage = decltype(by_linkage)::Zero();
  by_linkage(0, kX0) = 1;
  by_linkage(1, kY0) = 1;
  by_linkage(2, kLAC1) = by_linkage(2, kY0) = 1;
  by_linkage(3, kZ0) = s;
  by_linkage(4, kRC1) = by_linkage(4, kX0) = 1;
  by_linkage.row(5) = by_linkage.row(2);
  by_linkage(5, kLtA) += 1;
  by_linkage(6, kRA) = by_linkage(6, kZ0) = s;

  LinkageErrors result;
  result.covariance = by_linkage * covariance * by_linkage.transpose();
  const Eigen::VectorXd errors = by_linkage * change;
  const std::size_t c1 = machine.find_axis("C1"), a = machine.find_axis("A");
  const std::pair<std::size_t, Component> locations[] = {
      {c1, Component::X}, {c1, Component::Y}, {a, Component::Y}, {a, Component::Z}};
  for (Eigen::Index i = 0; i < 4; ++i) {
    const auto& [axis, component] = locations[i];
    result.errors.locations.push_back({axis, component, errors[i], std::sqrt(result.covariance(i, i))});
  }
  result.errors.tool_offset_error = errors.tail<3>();
  return result;
}

LinkageConvention linkage_convention_of(const Machine& machine) {
  const std::size_t x = machine.find_axis("X");
  if (x == Machine::npos) throw std::invalid_argument(machine.name + " has no axis X");
  return machine.axes[x].side == ChainSide::workpiece ? LinkageConvention::table_moves : LinkageConvention::head_moves;
}

}  // namespace abbe
