#pragma once

// Internal to plan: columns of a matrix as products take them.
#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <vector>

#include "abbe/geometry/cross_products.h"

namespace abbe {

/// Columns of a matrix with zeros behind each and behind the last one, for add_cross_products().
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
