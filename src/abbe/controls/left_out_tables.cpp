#include "abbe/controls/left_out_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "abbe/compensate/correction_uncertainty.h"
#include "abbe/errors/actual_pose.h"

namespace abbe {
namespace {

constexpr double kNoShift = 1e-9;  // mm; below is rounding

}  // namespace

std::string SmallTable::text() const {
  return fmt::format("{}: at most {:.2g} times its standard uncertainty", name, times);
}

std::vector<double> table_uncertainties(const ErrorSet& errors, const Eigen::MatrixXd& covariance,
                                        const std::vector<WrittenTable>& tables, double times,
                                        std::vector<SmallTable>& small) {
  std::vector<double> largest;
  for (const WrittenTable& table : tables) {
    const std::vector<double> uncertainty = propagated_uncertainty(errors, covariance, table.values);
    double ratio = 0;
    bool known = false;
    for (std::size_t k = 0; k < uncertainty.size(); ++k) {
      if (table.corrections[k] == 0) continue;
      known = known || uncertainty[k] > 0;
      ratio = uncertainty[k] > 0 ? std::max(ratio, std::abs(table.corrections[k]) / uncertainty[k]) : HUGE_VAL;
    }
    largest.push_back(uncertainty.empty() ? 0 : *std::max_element(uncertainty.begin(), uncertainty.end()));
    if (times > 0 && known && ratio < times) small.push_back({table.name, ratio});
  }
  return largest;
}

TablesTogether::TablesTogether(const Machine& machine, const ErrorSet& errors, const Eigen::MatrixXd& covariance,
                               const PoseList& poses, const CommandCorrection& all)
    : covariance_(covariance), poses_(poses) {
  Deviation deviation;
  Eigen::MatrixXd by_parameters, by_positions;
  for (std::size_t k = 0; k < poses.count(); ++k) {
    tool_deviation(machine, errors, poses.pose(k), deviation, &by_parameters, &by_positions);
    places_.push_back({by_parameters.topRows<3>(), by_positions.topRows<3>()});
  }
  all.evaluate(poses, all_);
}

bool TablesTogether::is_small(const CommandCorrection& without, double times) const {
  PoseList added;
  without.evaluate(poses_, added);
  for (std::size_t k = 0; k < places_.size(); ++k) {
    Eigen::Vector3d missing = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < added.axis.size(); ++i)
      missing += places_[k].by_positions.col(static_cast<Eigen::Index>(i)) * (all_.axis[i][k] - added.axis[i][k]);
    const double shift = missing.norm();
    if (!(shift > kNoShift)) continue;
    const Eigen::RowVectorXd slope = (missing / shift).transpose() * places_[k].by_parameters;
    const double variance = slope.dot(slope * covariance_);
    if (!(shift < times * std::sqrt(std::max(0.0, variance)))) return false;
  }
  return true;
}

std::vector<SmallTable> leave_out_tables(const Machine& machine, const ErrorSet& errors,
                                         const Eigen::MatrixXd& covariance, const PoseList& poses,
                                         const TableFormat& format, WriterRequest& request, double times,
                                         WrittenTables& tables, std::vector<SmallTable>& left_out) {
  std::vector<SmallTable> kept;
  if (left_out.empty()) return kept;
  const WrittenTables all = std::exchange(tables, WrittenTables{});
  const TablesTogether together(machine, errors, covariance, poses, *all.correction);
  std::stable_sort(left_out.begin(), left_out.end(),
                   [](const SmallTable& a, const SmallTable& b) { return a.times < b.times; });
  while (true) {
    request.left_out.clear();
    for (const SmallTable& table : left_out) request.left_out.insert(table.name);
    tables = format.write(machine, errors, request);
    if (left_out.empty() || together.is_small(*tables.correction, times)) return kept;
    kept.push_back(left_out.back());
    left_out.pop_back();
  }
}

}  // namespace abbe
