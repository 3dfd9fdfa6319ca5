#pragma once

#include <Eigen/Core>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "abbe/identify/linkage/dial_grid.h"

namespace abbe {

/// tests/golden/wang/dial_grid_*.csv: two grids of axis X without noise and what is in them.
struct WangGrids {
  DialGrid z_face, y_face;
  Eigen::VectorXd straightness_z, straightness_y;  ///< mm, without line
  Eigen::VectorXd roll;                            ///< rad
};

inline std::vector<std::vector<double>> golden_rows(const std::string& name) {
  std::ifstream file(std::string(ABBE_GOLDEN "/wang/") + name);
  if (!file) throw std::runtime_error("missing " + name);
  std::vector<std::vector<double>> rows;
  std::string line, field;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream fields(line);
    rows.emplace_back();
    while (std::getline(fields, field, ',')) rows.back().push_back(std::stod(field));
  }
  return rows;
}

inline WangGrids wang_grids() {
  const auto readings = golden_rows("dial_grid_noise0.csv"), truth = golden_rows("dial_grid_truth.csv");
  constexpr std::size_t kPlaces = 5;
  const Eigen::Index m = static_cast<Eigen::Index>(truth.size());
  WangGrids grids;
  grids.z_face.indications.resize(m, kPlaces);
  grids.y_face.indications.resize(m, kPlaces);
  grids.straightness_z.resize(m);
  grids.straightness_y.resize(m);
  grids.roll.resize(m);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Eigen::Index row = static_cast<Eigen::Index>(i);
    grids.z_face.positions.push_back(truth[i][0]);
    grids.straightness_z[row] = 1e-3 * truth[i][1];
    grids.straightness_y[row] = 1e-3 * truth[i][2];
    grids.roll[row] = 1e-6 * truth[i][3];
    for (std::size_t j = 0; j < kPlaces; ++j) {
      const std::vector<double>& reading = readings.at(i * kPlaces + j);
      grids.z_face.indications(row, static_cast<Eigen::Index>(j)) = 1e-3 * reading.at(3);
      grids.y_face.indications(row, static_cast<Eigen::Index>(j)) = 1e-3 * reading.at(4);
    }
  }
  grids.y_face.positions = grids.z_face.positions;
  for (std::size_t j = 0; j < kPlaces; ++j) {
    grids.z_face.across.push_back(readings[j][1]);
    grids.y_face.across.push_back(readings[j][2]);
  }
  return grids;
}

}  // namespace abbe
