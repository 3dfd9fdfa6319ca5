#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "abbe/identify/trust/trial_readings.h"

namespace abbe {

/// Share of a direction that may stay unseen for it to count as shown.
inline constexpr double kLeftUnseen = 0.1;

/// Singular value of rows, in standard uncertainties per typical size, up to which they do not show a direction: all
/// readings together change by no more than one standard uncertainty, or it is rounding.
/// @param norm  of the rows
double still_unseen(double norm);

/// The part of the space of `open` that the rows leave unseen, orthonormal columns. A direction counts as seen if
/// errors of typical size along it change the readings by more than their noise, and by more than rounding.
/// @param rows  [readings, parameters] in standard uncertainties per typical size
/// @param open  orthonormal columns [parameters, directions]
Eigen::MatrixXd left_open(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& open);

/// Words of a measurement without the comma of a sentence that was to go on.
std::string clause_of(const PossibleMeasurement& measurement);

/// Measurements that show together what none of them shows alone.
struct MeasurementsTogether {
  std::string words;    ///< theirs, in the order in which they take most away; empty: none helps
  bool enough = false;  ///< no more than kLeftUnseen is left
};

/// Up to four measurements, each the one that leaves least of what those before it left.
/// @param rows    per possible measurement: its rows as for left_open
/// @param open    what the readings at hand leave open, orthonormal columns [parameters, open directions]
/// @param unseen  what is to be shown, columns [parameters, directions], in parameters of typical size
MeasurementsTogether measurements_together(const std::vector<PossibleMeasurement>& possible,
                                           const std::vector<Eigen::MatrixXd>& rows, const Eigen::MatrixXd& open,
                                           const Eigen::MatrixXd& unseen);

}  // namespace abbe
