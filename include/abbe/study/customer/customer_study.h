#pragma once

#include <string>
#include <vector>

#include "abbe/report/customer/customer_report.h"
#include "abbe/study/study_result.h"

namespace abbe {

/// Names that the tolerances of a study's customer report may have: "V_max_um", "EXX_um", "EC0Y_urad", ...
std::vector<std::string> customer_tolerance_names(const Study& study);

/// Whether a customer report can be made of a study, before it is computed; nothing to do for a study without facts.
/// @throws InputError for facts of a study that identifies nothing, and for a tolerance of a figure that there is not
void check_customer_report(const Study& study);

/// Opens the result before a correction that the study names. @throws InputError
EarlierResult read_earlier_result(const Study& study);

/// Customer report on an identification: volumetric error, error motions, location errors and reversal values of the
/// machine as measured with their expanded uncertainties, what is predicted after correction, and the errors of each
/// axis at positions.
///
/// The figure of an error motion is its largest minus its smallest value at 121 positions over the range in which it is
/// known; its uncertainty is that of the difference of the values at these two positions, from the covariance of the
/// identified errors. The extremes are taken as fixed. The largest volumetric error is over the poses of
/// StudyResult::volumetric, with its uncertainty at its pose. Verdicts are given on measured machines only. With a
/// result before a correction, its figures stand in place of the predicted ones: those of errors that both have
/// identified.
/// @param study  with facts
CustomerReport study_customer_report(const Study& study, const StudyResult& result);

/// The same as a digital calibration certificate, with all identified errors and their covariance, and without what is
/// predicted.
/// @param study  whose facts name a laboratory, as check_customer_report() wants them
std::string study_certificate(const Study& study, const StudyResult& result);

/// The same as results in QIF, without what is predicted. @param study  with facts
std::string study_qif_results(const Study& study, const StudyResult& result);

}  // namespace abbe
