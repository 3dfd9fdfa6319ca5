#pragma once

#include <array>
#include <string>

#include "abbe/report/evaluations/evaluation_report.h"
#include "abbe/verify/evaluations/circular.h"
#include "abbe/verify/evaluations/circular_diagnosis.h"
#include "abbe/verify/evaluations/differential_expansion.h"

namespace abbe {

/// Settings of a circular test, besides its readings.
struct CircularRequest {
  std::string file;
  std::string plane = "XY";  ///< first and second axis
  CircularOptions circular;
  DiagnosisOptions diagnosis;
  double feed_mm_s = 0;  ///< along the path; 0: not known
};

/// Radii that were corrected to 20 degC before they were evaluated.
struct CircularCorrection {
  DifferentialExpansion expansion;
  bool has_machine = false, has_instrument = false;  ///< bodies with a temperature
  BodyTemperatures at;
  double factor = 1;       ///< by which radii were multiplied
  double uncertainty = 0;  ///< standard, of the correction of the nominal radius, mm
  CircularResult as_read;
};

/// Figures, causes, plots and notes of a circular test.
/// @param result, diagnosis  of these readings with the options of the request
/// @param correction         of the readings; null: they are as read
EvaluationReport circular_report(const CircularRequest& request, const std::array<CircularReadings, 2>& paths,
                                 const CircularResult& result, const CircularDiagnosis& diagnosis,
                                 const CircularCorrection* correction = nullptr);

}  // namespace abbe
