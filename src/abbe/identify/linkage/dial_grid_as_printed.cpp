#include "abbe/identify/linkage/dial_grid_as_printed.h"

namespace abbe {
namespace {

/// Slopes k_.j of the columns: along the motion.
Eigen::VectorXd column_slopes(const DialGrid& grid) {
  const DialGrid turned{grid.across, grid.positions, grid.indications.transpose()};
  return fit_rows(turned, 0).slope;
}

}  // namespace

DialGridAsPrinted decouple_grids_as_printed(const DialGrid& z_face, const DialGrid& y_face) {
  const Eigen::VectorXd z_rows = fit_rows(z_face, 0).slope, y_rows = fit_rows(y_face, 0).slope;
  const Eigen::VectorXd z_columns = column_slopes(z_face), y_columns = column_slopes(y_face);
  const Eigen::Map<const Eigen::VectorXd> across(z_face.across.data(), static_cast<Eigen::Index>(z_face.across.size()));
  const Eigen::Map<const Eigen::VectorXd> along(y_face.positions.data(),
                                                static_cast<Eigen::Index>(y_face.positions.size()));
  DialGridAsPrinted result;
  result.straightness_z = (z_face.indications - z_rows * across.transpose()).rowwise().mean();
  result.roll_from_z = z_rows.array().atan();
  result.pitch = z_columns.array().atan().mean();
  result.straightness_y = (y_face.indications - along * y_columns.transpose()).rowwise().mean();
  result.roll_from_y = y_rows.array().atan();
  result.yaw = y_columns.array().atan().mean();
  result.roll = (result.roll_from_z + result.roll_from_y) / 2;
  return result;
}

}  // namespace abbe
