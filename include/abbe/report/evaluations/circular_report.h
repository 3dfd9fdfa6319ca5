#pragma once

#include <array>
#include <string>

#include "abbe/report/evaluations/evaluation_report.h"
#include "abbe/verify/evaluations/circular_diagnosis.h"

namespace abbe {

/// What a circular test was asked, beside its readings.
struct CircularRequest {
  std::string file;
  std::string plane = "XY";  ///< first and second axis
  CircularOptions circular;
  DiagnosisOptions diagnosis;
  double feed_mm_s = 0;  ///< along the path; 0: not known
};

/// Figures, causes, plots and notes of a circular test.
/// @param result, diagnosis  of these readings with the options of the request
EvaluationReport circular_report(const CircularRequest& request, const std::array<CircularReadings, 2>& paths,
                                 const CircularResult& result, const CircularDiagnosis& diagnosis);

}  // namespace abbe
