#pragma once

#include <string>
#include <vector>

#include "abbe/formats/machine/map_file.h"
#include "abbe/study/study_result.h"

namespace abbe {

/// Writes everything a study has computed into its results folder, completely or not at all.
///
/// machine.toml, errors.toml with errors.covariance.csv, summary.json, residuals.csv, readings (simulated studies),
/// maps/, report.html, customer-report.html (studies that state its facts),
/// calibration-certificate.xml (those that name a laboratory).
/// @param customer_pdf  of print_page(), written as customer-report.pdf; empty: there is none
/// @returns the text of summary.json
std::string write_results(const Study& study, const StudyResult& result, const std::string& customer_pdf = "");

/// Map as the files hold it.
/// @param after, uncertainty  may be null
MapData map_data(const Machine& machine, const PoseList& poses, const std::vector<std::size_t>& grid,
                 const ErrorMap& before, const ErrorMap* after, const ErrorMap* uncertainty);

/// Residuals as CSV, one line per component of a reading: set-up, reading, axis positions, used, weight, component,
/// normalised residual, residual with its unit.
std::string residuals_csv(const Study& study, const StudyResult& result);

}  // namespace abbe
