#include "abbe/verify/parts/deviation_jacobian.h"

#include <algorithm>

namespace abbe {

void for_each_deviation_jacobian(const DeviationModel& model, const DeviationBlock& block,
                                 const std::vector<std::size_t>& parameters, Eigen::Index rows,
                                 const std::function<void(std::size_t, Eigen::Index, const Eigen::MatrixXd&)>& visit) {
  constexpr std::size_t kPart = ChainPlan::kBlockSize;
  const std::vector<double> zero(kPart, 0.0), one(kPart, 1.0);
  const double* unit[3][3];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) unit[i][j] = i == j ? one.data() : zero.data();
  }
  std::vector<RowArrays> arrays;
  for (int i = 0; i < 3; ++i) arrays.push_back({{unit[i][0], unit[i][1], unit[i][2]}, {}});
  for (int i = 0; i < rows - 3; ++i) {
    arrays.push_back({{zero.data(), zero.data(), zero.data()}, {unit[i][0], unit[i][1], unit[i][2]}});
  }
  std::vector<double> start[3];
  for (int c = 0; c < 3; ++c) start[c].assign(kPart, model.actual_tip()[c]);
  std::vector<const double*> shifted;
  Eigen::MatrixXd jacobian(rows * static_cast<Eigen::Index>(kPart), static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t from = 0; from < block.count; from += kPart) {
    const std::size_t number = std::min(kPart, block.count - from);
    model.actual().differentiate(
        block.position_arrays(shifted, from, number), {start[0].data(), start[1].data(), start[2].data()},
        {block.seen[0].data() + from, block.seen[1].data() + from, block.seen[2].data() + from}, arrays, parameters,
        jacobian.data(), static_cast<std::size_t>(jacobian.rows()));
    visit(from, static_cast<Eigen::Index>(number), jacobian);
  }
}

}  // namespace abbe
