#pragma once

#include <Eigen/Core>
#include <array>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "abbe/errors/chain_plan.h"
#include "abbe/errors/error_set.h"
#include "abbe/errors/poses.h"
#include "abbe/formats/machine/map_file.h"
#include "abbe/machine/machine.h"
#include "abbe/verify/evaluations/statistics.h"
#include "wang/study.h"

namespace abbe {

/// Equation (18) over many poses, E = (W_actual - T_actual) - (W_nominal - T_nominal) in the machine frame: W is the
/// point of the workpiece, T that of the tool. Both are fixed to their bodies; they meet
/// only where the program says so, which E does not need.
class WangIntegratedPlan {
 public:
  /// @param workpiece_point  in the workpiece frame, mm
  WangIntegratedPlan(const Machine& machine, const ErrorSet& errors,
                     const Eigen::Vector3d& workpiece_point = wang_workpiece_point());

  /// @param error            [count] each of x, y, z: E, mm
  /// @param machining_point  [count] T_nominal - W_nominal, which (33) and (34) call the machining point, mm; may be
  /// null
  void evaluate(PositionArrays positions, PointArrays error, PointArrays machining_point = {}) const;

  /// Covariance of E at one pose.
  /// @param covariance  of all parameters of the errors, mm and rad
  Eigen::Matrix3d covariance_at(const std::vector<double>& positions, const Eigen::MatrixXd& covariance) const;

 private:
  Eigen::Vector3d tool_offset_, workpiece_point_;
  std::size_t parameters_ = 0;
  ChainPlan tool_actual_, tool_nominal_, work_actual_, work_nominal_;
};

/// E at given poses.
struct WangMap {
  PoseList poses;
  std::vector<std::size_t> counts;                            ///< of a grid, per axis of the chain; empty: no grid
  std::array<std::vector<double>, 3> machining_point, error;  ///< machine frame, mm
  std::array<std::vector<double>, 3> uncertainty;             ///< standard, mm; empty: none is known
  std::vector<double> norm, norm_uncertainty;                 ///< |E| and its standard uncertainty, mm
  SampleStatistics statistics;                                ///< of norm
};

/// All poses of a grid, the last axis fastest.
PoseList wang_poses_of(const PoseGrid& grid);

/// @param covariance  of all parameters of the errors, mm and rad; null: no uncertainty
WangMap wang_map(const ErrorSet& errors, const PoseList& poses, const Eigen::MatrixXd* covariance = nullptr);
/// Grid of four of the measured positions of every axis: i = 1, 4, 7, 11 of the tables. The zero pose is one of them.
WangMap wang_grid_map(const ErrorSet& errors, const Eigen::MatrixXd* covariance = nullptr);

/// What the map's files hold: machining points, axis commands, `E` in um and, if known, its standard uncertainty.
MapData wang_map_data(const WangMap& map);
/// The `map` section of the page.
nlohmann::ordered_json wang_report_map(const WangMap& map, const std::string& description);

}  // namespace abbe
