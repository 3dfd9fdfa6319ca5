#pragma once

// Candidates and matrices of random numbers.
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>

#include "abbe/errors/random_stream.h"
#include "abbe/identify/planning_candidates.h"

namespace abbe::test {

/// [count] candidates of normal numbers, with so many rows each.
inline PlanningCandidates random_candidates(std::size_t count, std::size_t rows, std::size_t parameters,
                                            std::uint64_t seed) {
  PlanningCandidates candidates;
  candidates.rows.resize(static_cast<Eigen::Index>(count * rows), static_cast<Eigen::Index>(parameters));
  RandomStream random(seed);
  for (Eigen::Index i = 0; i < candidates.rows.rows(); ++i)
    for (Eigen::Index j = 0; j < candidates.rows.cols(); ++j) candidates.rows(i, j) = random.normal();
  for (std::size_t i = 0; i <= count; ++i) candidates.first_row.push_back(i * rows);
  return candidates;
}

/// [rows, columns] normal numbers.
inline Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns, std::uint64_t seed) {
  RandomStream random(seed);
  Eigen::MatrixXd matrix(rows, columns);
  for (Eigen::Index i = 0; i < rows; ++i)
    for (Eigen::Index j = 0; j < columns; ++j) matrix(i, j) = random.normal();
  return matrix;
}

}  // namespace abbe::test
