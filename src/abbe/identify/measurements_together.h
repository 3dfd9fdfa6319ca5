#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "abbe/identify/trial_readings.h"

namespace abbe {

/// Share of a direction that may stay unseen for it to count as shown.
inline constexpr double kLeftUnseen = 0.1;

/// Words of a measurement without the comma of a sentence that was to go on.
std::string clause_of(const PossibleMeasurement& measurement);

/// Measurements that show together what none of them shows alone.
struct MeasurementsTogether {
  std::string words;    ///< theirs, in the order in which they take most away; empty: none helps
  bool enough = false;  ///< no more than kLeftUnseen is left
};

/// Up to three measurements, each the one that leaves least of what those before it left.
/// @param left    per possible measurement: what it leaves open, orthonormal columns [parameters, open directions]
/// @param unseen  what is to be shown, columns [parameters, directions], in parameters of typical size
MeasurementsTogether measurements_together(const std::vector<PossibleMeasurement>& possible,
                                           const std::vector<Eigen::MatrixXd>& left, const Eigen::MatrixXd& unseen);

}  // namespace abbe
