#pragma once

// Internal to formats: numbers of a set-up with what is known of them.
#include <optional>
#include <string_view>
#include <vector>

#include "abbe/formats/text/toml_table.h"
#include "abbe/instruments/setup_quantity.h"

namespace abbe {

/// A number NAME with what is known of it, for base = NAME and its unit:
///
///     NAME_um = 3                        the value, or where the estimate starts
///     NAME_standard_uncertainty_um = 0.5 known within this, and estimated
///     estimate_NAME = true               estimated from the readings alone; false: exact
///     true_NAME_um = 3.2                 what it really is; simulation only
///
/// @param unstated   knowledge if the file says neither
/// @param otherwise  value if the file has none; nothing: it is required
SetupNumber read_setup_number(TomlTable& table, std::string_view base, Quantity quantity, Knowledge unstated,
                              bool simulated, std::optional<double> otherwise = std::nullopt);

/// The same for three coordinates; the uncertainty is one number or three.
SetupPoint read_setup_point(TomlTable& table, std::string_view base, Knowledge unstated, bool simulated,
                            std::optional<Eigen::Vector3d> otherwise = std::nullopt);

/// Tables [[KEY]] with `name` and the point `centre`: balls, spheres. @throws InputError if there is none
std::vector<NamedPoint> read_named_points(TomlTable& table, std::string_view key, Knowledge unstated, bool simulated);

/// A standard uncertainty of the instrument, > 0. @throws InputError if it is missing or zero
double read_noise(TomlTable& table, std::string_view base, Quantity quantity);

}  // namespace abbe
