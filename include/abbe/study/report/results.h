#pragma once

#include <optional>
#include <string>
#include <vector>

#include "abbe/formats/machine/map_file.h"
#include "abbe/geometry/numbered_work.h"
#include "abbe/study/study_result.h"

namespace abbe {

/// Files of the results folder that were made beforehand.
struct ReadyFiles {
  std::string customer_pdf{};                  ///< of print_page(); empty: there is none
  std::optional<std::string> residuals_csv{};  ///< of residuals_csv(); none: write_results() makes it
};

/// Writes everything a study has computed into its results folder, completely or not at all.
///
/// machine.toml, errors.toml with errors.covariance.csv, summary.json, residuals.csv, readings (simulated studies),
/// maps/, report.html, customer-report.html (studies that state its facts),
/// calibration-certificate.xml (those that name a laboratory).
/// @returns the text of summary.json
std::string write_results(const Study& study, const StudyResult& result, const ReadyFiles& ready = {});

/// Map as the files hold it.
/// @param after, uncertainty  may be null
MapData map_data(const Machine& machine, const PoseList& poses, const std::vector<std::size_t>& grid,
                 const ErrorMap& before, const ErrorMap* after, const ErrorMap* uncertainty);

/// Residuals as CSV, one line per component of a reading: set-up, reading, axis positions, used, weight, component,
/// normalised residual, residual with its unit.
/// @param work  driver of the job: several processes share the rows, and the first one has them all
std::string residuals_csv(const Study& study, const StudyResult& result, const WorkDriver& work = {});

}  // namespace abbe
