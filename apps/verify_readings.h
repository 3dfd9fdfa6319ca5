#pragma once

#include <optional>
#include <string>

#include "abbe/study/verification/verification.h"

namespace abbe {

/// Options of abbe verify --readings.
struct VerifyReadingsOptions {
  VerificationFiles files;
  std::string study;  ///< --readings
  std::optional<double> least_reduction, largest_ratio;
  std::string page;  ///< empty: none
  bool json = false, accept_uncovered = false;
};

/// Compares the readings of a study with identified errors, and prints what is left. @returns the exit code
int run_verify_readings(const VerifyReadingsOptions& options);

}  // namespace abbe
