#include "abbe/controls/believed_correction.h"

#include <utility>

#include "abbe/geometry/decompositions.h"

namespace abbe {

BelievedCorrection::BelievedCorrection(Machine nominal, BelievedMachine believed)
    : nominal_(std::move(nominal)), believed_(std::move(believed)) {}

void BelievedCorrection::evaluate(const PoseList& commands, PoseList& correction) const {
  std::vector<std::size_t> linear;
  for (std::size_t i = 0; i < nominal_.axes.size(); ++i) {
    if (nominal_.axes[i].kind == AxisKind::linear) linear.push_back(i);
  }
  correction.axis.assign(commands.axis.size(), std::vector<double>(commands.count(), 0.0));
  correction.approach.clear();
  Eigen::MatrixXd moves(3, static_cast<Eigen::Index>(linear.size()));
  for (std::size_t k = 0; k < commands.count(); ++k) {
    std::vector<double> pose = commands.pose(k);
    const Eigen::Vector3d wanted = nominal_workpiece_from_tool(nominal_, pose).translation;
    const Eigen::Vector3d there = nominal_workpiece_from_tool(believed_.machine, pose).translation;
    for (std::size_t j = 0; j < linear.size(); ++j) {
      pose[linear[j]] += 1;
      moves.col(static_cast<Eigen::Index>(j)) =
          nominal_workpiece_from_tool(believed_.machine, pose).translation - there;
      pose[linear[j]] -= 1;
    }
    for (std::size_t i = 0; i < pose.size(); ++i) correction.axis[i][k] = -believed_.zero[i];
    if (linear.empty()) continue;
    const Eigen::VectorXd added = CompleteOrthogonal(moves).solve(wanted - there);
    for (std::size_t j = 0; j < linear.size(); ++j) {
      correction.axis[linear[j]][k] = added[static_cast<Eigen::Index>(j)];
    }
  }
}

}  // namespace abbe
