#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "abbe/report/customer/customer_report.h"

namespace abbe {

/// Identified errors with their covariance, for a certificate that programs read.
struct CertifiedErrors {
  std::vector<std::string> names;  ///< of the parameters: "EXX.1", without blanks
  std::vector<bool> is_angle;      ///< urad, else um
  std::vector<double> values;      ///< um, urad
  Eigen::MatrixXd covariance;      ///< of all of them, products of these units
};

/// What a digital calibration certificate needs and the facts do not state, as keys of [report]: "laboratory.name".
std::vector<std::string> missing_for_certificate(const ReportFacts& facts);

/// A customer report as a digital calibration certificate (DCC) of PTB, version 3.2.1, with quantities by D-SI 2.1.0:
/// the figures of every state with their expanded uncertainties (k = 2) and verdicts, the mean temperature, and, if
/// given, the identified errors with an ellipsoidal region of coverage 95 %, whose factor is the root of the quantile
/// of chi-square with as many degrees of freedom as the covariance has rank.
///
/// It is not signed. Drawings and tables are not in it.
/// Source: https://ptb.de/dcc/v3.2.1/dcc.xsd and https://ptb.de/si/v2.1.0/SI_Format.xsd.
/// @throws std::invalid_argument if something is missing_for_certificate()
std::string calibration_certificate(const CustomerReport& report, const std::optional<CertifiedErrors>& errors = {});

}  // namespace abbe
