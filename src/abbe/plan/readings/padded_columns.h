#pragma once

// Internal to plan: a matrix in the form that add_cross_products() takes.
#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <vector>

#include "abbe/geometry/cross_products.h"

namespace abbe {

/// The columns of a matrix, each padded with zeros, and columns of zeros behind the last one.
struct PaddedColumns {
  explicit PaddedColumns(const Eigen::MatrixXd& matrix)
      : count(padded(static_cast<std::size_t>(matrix.cols()), kColumnMultiple)),
        length(padded(static_cast<std::size_t>(matrix.rows()), kLengthMultiple)),
        numbers(count * length) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j)
      std::copy_n(matrix.col(j).data(), matrix.rows(), &numbers[static_cast<std::size_t>(j) * length]);
  }

  std::size_t count, length;
  std::vector<double> numbers;  ///< [count][length]
};

}  // namespace abbe
