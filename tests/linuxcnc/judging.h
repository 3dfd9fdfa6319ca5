#pragma once

// What the judges of runs in LinuxCNC share: reading what was recorded, and figures.
#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "abbe/errors/error_set.h"

namespace abbe {

[[noreturn]] inline void fail(const std::string& what) {
  std::printf("FAILED: %s\n", what.c_str());
  std::exit(1);
}

/// Rows of so many numbers, between blanks or commas; other lines (a heading) are left out.
inline std::vector<std::vector<double>> rows(const std::string& path, std::size_t columns) {
  std::ifstream file(path);
  std::vector<std::vector<double>> all;
  for (std::string line; std::getline(file, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    std::vector<double> row;
    for (double value = 0; words >> value;) row.push_back(value);
    if (row.size() == columns) all.push_back(row);
  }
  return all;
}

/// Errors as an identification could leave them.
/// @param part  standard deviation of every parameter from the truth, of itself
inline ErrorSet nearly(const ErrorSet& truth, double part, std::mt19937_64& generator) {
  ErrorSet identified = truth;
  std::vector<double> values = truth.parameters();
  std::normal_distribution<double> normal;
  for (double& value : values) value *= 1 + part * normal(generator);
  identified.set_parameters(values);
  return identified;
}

struct Mean {
  double sum = 0, largest = 0;
  std::size_t count = 0;
  void add(double value) {
    sum += value;
    largest = std::max(largest, value);
    ++count;
  }
  double mean() const { return count > 0 ? sum / static_cast<double>(count) : 0; }
};

inline double distance_to_segment(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d along = b - a;
  const double square = along.squaredNorm();
  const double share = square > 0 ? std::min(1.0, std::max(0.0, along.dot(p - a) / square)) : 0;
  return (p - a - share * along).norm();
}

}  // namespace abbe
