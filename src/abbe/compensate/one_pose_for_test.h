#pragma once

#include <vector>

#include "abbe/compensate/compensated_inverse.h"

namespace abbe::test {

/// Corrected commands for the nominal ones of a single pose; mm and rad.
inline std::vector<double> corrected(const CompensatedInverse& inverse, const std::vector<double>& nominal,
                                     CorrectionStatus& status) {
  std::vector<double> commands(nominal);
  std::vector<const double*> in;
  std::vector<double*> out;
  for (std::size_t i = 0; i < nominal.size(); ++i) {
    in.push_back(&nominal[i]);
    out.push_back(&commands[i]);
  }
  inverse.correct({in, 1}, {out, &status, nullptr, nullptr});
  return commands;
}

}  // namespace abbe::test
