#pragma once

// What identified errors leave of new measured readings, as `abbe verify --readings` does it:
//
//   #include <abbe/study/run_study.h>
//   #include <abbe/study/verification/verified_readings.h>
//
//   #include <cstdio>
//
//   int main() {
//     abbe::ReadingsToVerify request;
//     request.study = abbe::read_study("examples/verify/second-tracker.study.toml");
//     request.errors_file = "examples/compensate/trunnion.errors.toml";
//     request.identified = abbe::read_errors(request.errors_file, request.study.machine);
//     request.least_reduction = 3;  // the mean residual has to become three times smaller
//     const abbe::VerifiedReadings result = abbe::verify_readings(request);
//     std::printf("mean residual: %.2f um before, %.2f um after\n", 1e3 * result.before_statistics.mean,
//                 1e3 * result.after_statistics.mean);
//     std::printf("%.2f times what the uncertainties explain\n", result.ratio());
//     return result.says_no() ? 1 : 0;  // evaluation_text(result.report) says more
//   }
//
// It prints:
//
//   mean residual: 12.39 um before, 2.64 um after
//   1.00 times what the uncertainties explain
//
// Method and figures: docs/verify.md.

#include <optional>
#include <string>
#include <vector>

#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/study/study.h"
#include "abbe/identify/trust/independent_readings.h"
#include "abbe/report/evaluations/evaluation_report.h"
#include "abbe/study/campaign.h"
#include "abbe/study/job_options.h"
#include "abbe/verify/evaluations/statistics.h"
#include "abbe/verify/left_out_poses.h"

namespace abbe {

/// Readings, and the errors that they are compared with. Messages name a field by the option of `abbe verify`.
struct ReadingsToVerify {
  Study study;              ///< machine, set-ups and readings; what it identifies plays no part
  ErrorsFile identified;    ///< of this machine
  std::string errors_file;  ///< name for texts and messages
  /// [states of the machine] --state: values where the readings give none, NaN where not stated; empty: none
  std::vector<double> states{};
  std::optional<double> least_reduction;  ///< --least-reduction: of the mean residual, times smaller; above zero
  std::optional<double> largest_ratio;    ///< --largest-ratio: to what the uncertainties explain; above zero
};

/// A requirement on readings, and whether they meet it.
struct ReadingsVerdict {
  std::string name;  ///< "improvement", "consistency", "reduction" or "ratio"
  std::string text;
  bool met = true;
};

/// Residuals of one set-up, [readings]: length of measured - modelled, mm; negative: left out, or without a length.
struct SetupResiduals {
  std::string name;
  std::vector<double> before, after;  ///< of the nominal machine, and with the identified errors
};

/// What identified errors leave of readings. It holds no reference to the request.
struct VerifiedReadings {
  std::size_t readings = 0;     ///< with those left out
  std::size_t not_covered = 0;  ///< left out: some axis is where the errors are not known
  /// [readings compared that have a length] length of measured - modelled with the set-ups fitted, mm: of the nominal
  /// machine, and of the machine with the identified errors.
  std::vector<double> before, after;
  SampleStatistics before_statistics, after_statistics;
  std::vector<SetupResiduals> setups;  ///< the same by set-up, as in judged.norm
  bool uncertainties_known = true;     ///< false: the errors have none, so only those of the readings count
  IndependentReadings judged;
  std::vector<ReadingsVerdict> verdicts;
  std::vector<std::string> warnings;
  std::vector<std::string> outside;  ///< states of readings beyond what the errors were measured at, a sentence each
  EvaluationReport report;           ///< kind "readings", with all of the above

  /// Mean residual of the nominal machine over that with the identified errors; 0 without lengths.
  double reduction() const;
  /// What is left over what the uncertainties of readings and errors explain, root mean square; 0: nothing to judge.
  double ratio() const;
  LeftOutPoses left_out() const;
  bool says_no() const;
};

/// Compares readings that took no part in an identification with its errors. Stations, reflectors and whatever else the
/// study does not state of a set-up are fitted to these readings, with the errors held.
///
/// Errors with states are taken at the state of each reading: from its columns, recorded channels, or the request.
///
/// Verdicts: residuals are smaller than without the errors; the uncertainties of readings and errors explain what is
/// left (as Distrust does, with a probability of 1e-6); and what the request asks for.
/// @param options  progress: steps done of three
/// @throws InputError for readings that cannot be read, that do not determine their set-ups, or of which none is where
///   the errors are known, or whose states are not given; Stopped
VerifiedReadings verify_readings(const ReadingsToVerify& request, const JobOptions& options = {});

}  // namespace abbe
