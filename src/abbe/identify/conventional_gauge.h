#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "abbe/identify/gauge.h"
#include "abbe/identify/gauge_convention.h"

namespace abbe {

/// Which candidates fix the unseen directions: those of the convention, in its order, as far as they fix anything.
class ConventionalGauge {
 public:
  /// @param candidates  in the order of the convention; have to outlive this
  /// @param scale  [p], positive norms of the columns
  /// @param open  [p, q], orthonormal, the unseen directions in scaled parameters
  ConventionalGauge(const std::vector<GaugeCandidate>& candidates, const Eigen::VectorXd& scale,
                    const Eigen::MatrixXd& open);

  /// Indices of the candidates that are taken, at most q. To be called once.
  std::vector<std::size_t> chosen(GaugeOrder order);

  /// [q, taken], orthonormal: the part of the unseen directions that they fix.
  const Eigen::MatrixXd& fixed() const { return fixed_; }

 private:
  bool is_complete() const { return fixed_.cols() == fixed_.rows(); }
  Eigen::VectorXd part_left_open(std::size_t candidate) const;
  bool has_to_wait(std::size_t candidate, const Eigen::VectorXd& part) const;
  void take(std::size_t candidate);
  void take_waiting();
  void take_firmest(std::size_t first);

  const std::vector<GaugeCandidate>& candidates_;
  Eigen::MatrixXd parts_;  // [q, candidates], of each candidate in the unseen directions, as cosines
  Eigen::MatrixXd fixed_;
  std::vector<std::size_t> chosen_, waiting_;
};

}  // namespace abbe
