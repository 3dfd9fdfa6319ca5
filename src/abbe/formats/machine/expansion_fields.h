#pragma once

// Internal to formats: an expansion in an errors file or a study.
#include <Eigen/Core>
#include <string>
#include <vector>

#include "abbe/errors/expansion.h"
#include "abbe/formats/text/toml_table.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Beyond that a coefficient is a mistake in its unit, 1/K. Plastics reach 200 um/(m K).
inline constexpr double kLargestExpansion = 1e-3;

/// Keys `axis`, `state`, `fixed_point` and `temperature_standard_uncertainty`. @throws InputError
ScaleExpansion read_expansion_place(TomlTable& table, const Machine& machine);

/// @throws InputError at the key of the coefficient
void refuse_large_expansion(const TomlTable& table, double coefficient);

/// A whole table [[expansion]] of an errors file. @throws InputError
ScaleExpansion read_expansion(TomlTable& table, const Machine& machine);

/// Covariance of errors that state their standard uncertainties, with what expansions of one thermometer share; 0 x 0:
/// they share nothing.
/// @param first  parameter with which the expansions begin
Eigen::MatrixXd covariance_with_thermometers(const Machine& machine, const ErrorSet& errors,
                                             const std::vector<ScaleExpansion>& expansions, std::size_t first);

/// "  # scale of X: 8.3 um/(m K), fixed at 0 mm" behind the name of a term that is an expansion; else nothing.
std::string expansion_comment(const Machine& machine, const ErrorMotion& term);

}  // namespace abbe
