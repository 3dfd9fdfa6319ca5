#pragma once

#include <array>
#include <span>
#include <vector>

#include "abbe/controls/described_chain.h"
#include "abbe/errors/error_set.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// What of the errors of an axis stands in its tables: a correction of its own command, and the six rows in front of it
/// (X Y Z A B C, in this order) that make of the axis the one with all its errors. All are functions of its command.
///
/// With X(q) the displacement by the axis with its errors as the description goes (from tool to table), and N(q) that
/// of the rows behind, which are MachAxis between its tilts,
///     rows(q) = X(q + own(q)) N(q)^-1,
/// where own(q) leaves nothing of the rows along (about) the axis itself. So they hold errors about the origin of the
/// frame that the control has there, and not about the reference point of the machine file.
class DescribedErrors {
 public:
  static constexpr std::size_t kCount = 7;  ///< own, C1 to C6
  using Values = std::array<double, kCount>;

  DescribedErrors(const Machine& machine, const ErrorSet& errors, const DescribedAxis& axis);
  /// At a command, mm or rad. The rows move the frame by C1 to C6.
  Values at(double command) const;
  /// [kCount][positions]
  std::vector<std::vector<double>> at(std::span<const double> positions) const;

 private:
  const Machine& machine_;
  const ErrorSet& errors_;
  DescribedAxis axis_;
  Eigen::Vector3d along_;  ///< of the axis with its location errors, as the description moves
};

}  // namespace abbe
