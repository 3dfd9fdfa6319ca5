#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "abbe/verify/volumetric_figures.h"

namespace abbe {

/// For people: one line that says over which poses, and a line for each figure; empty without poses.
/// @param covers  empty, or what the prediction covers: "identified errors only"
std::string volumetric_text(const VolumetricFigures& figures, const std::string& covers = "");

/// One line of it: a name, then mean, 95 % and maximum in um.
std::string error_line(const std::string& name, const SampleStatistics& statistics);

/// Adds `predicted_volumetric_error` and `true_volumetric_error` (docs/report-data.md), each if it is known.
void add_volumetric_figures(const VolumetricFigures& figures, nlohmann::ordered_json& json,
                            const std::string& covers = "");

/// The headline in one sentence: the true error where it is known, else the predicted one with its coverage.
std::string volumetric_sentence(const VolumetricFigures& figures, const std::string& covers = "");

}  // namespace abbe
