#include "abbe/study/report/results.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/machine/map_file.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/report/report.h"
#include "abbe/study/customer/customer_study.h"
#include "abbe/study/identification/trust.h"
#include "abbe/study/report/report_data.h"
#include "abbe/study/report/summary.h"

namespace abbe {
namespace {

MapField field(std::string name, const std::array<std::vector<double>, 3>& values, Quantity quantity,
               std::string unit) {
  return {std::move(name), quantity, std::move(unit), {values[0], values[1], values[2]}};
}

}  // namespace

MapData map_data(const Machine& machine, const PoseList& poses, const std::vector<std::size_t>& grid,
                 const ErrorMap& before, const ErrorMap* after, const ErrorMap* uncertainty) {
  MapData data;
  data.points = before.point;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Axis& axis = machine.axes[i];
    data.fields.push_back({axis.name,
                           axis.kind == AxisKind::rotary ? Quantity::angle : Quantity::length,
                           position_suffix(axis),
                           {poses.axis[i]}});
  }
  data.fields.push_back(field("before", before.displacement, Quantity::length, "um"));
  if (!before.rotation[0].empty())
    data.fields.push_back(field("before_rotation", before.rotation, Quantity::angle, "urad"));
  if (after != nullptr) {
    data.fields.push_back(field("after", after->displacement, Quantity::length, "um"));
    if (!after->rotation[0].empty())
      data.fields.push_back(field("after_rotation", after->rotation, Quantity::angle, "urad"));
  }
  if (uncertainty != nullptr && !uncertainty->norm_uncertainty.empty()) {
    data.fields.push_back({"standard_uncertainty", Quantity::length, "um", {uncertainty->norm_uncertainty}});
  }
  // Grids of the study run with the last axis fastest, map files with the first direction fastest.
  data.grid.assign(grid.rbegin(), grid.rend());
  if (std::find(before.covered.begin(), before.covered.end(), 0) != before.covered.end()) {
    // Outside the measured range there is no result, so there is no point either.
    data.grid.clear();
    const auto keep_covered = [&](std::vector<double>& values) {
      std::size_t kept = 0;
      for (std::size_t k = 0; k < values.size(); ++k) {
        if (before.covered[k] != 0) values[kept++] = values[k];
      }
      values.resize(kept);
    };
    for (std::vector<double>& values : data.points) keep_covered(values);
    for (MapField& map_field : data.fields) {
      for (std::vector<double>& values : map_field.components) keep_covered(values);
    }
  }
  return data;
}

std::string write_results(const Study& study, const StudyResult& result, const ReadyFiles& ready) {
  const nlohmann::ordered_json summary = study_summary(study, result);
  std::string summary_text = json_text(summary);
  ResultsFolder folder(study.output);
  folder.write("summary.json", summary_text);
  folder.write("machine.toml", machine_text(study.machine));
  if (result.campaign.truth) {
    for (const CampaignSetup& setup : result.campaign.setups) {
      folder.write("readings/" + setup.name + ".csv", setup.readings_text(study.machine));
    }
    ErrorsFile truth{
        .errors = *result.campaign.truth, .covariance = {}, .provenance = {{"method", kTruthOfSimulation}}};
    folder.write("truth.errors.toml", errors_text(study.machine, truth));
  }
  if (result.usable()) {
    ErrorsFile errors = identified_errors_file(study, result);
    errors.provenance = {
        {"study", study.name}, {"method", "abbe identify"}, {"gauge", "ISO 230 conventions, see report"}};
    folder.write("errors.toml", errors_text(study.machine, errors, "errors.covariance.csv"));
    folder.write("errors.covariance.csv", covariance_text(study.machine, errors));
    if (ready.residuals_csv) {
      folder.write("residuals.csv", *ready.residuals_csv);
    } else {
      folder.write("residuals.csv", residuals_csv(study, result));
    }
  }
  if (result.map) {
    const StudyMap& map = *result.map;
    const MapData data =
        map_data(study.machine, map.poses, map.grid, map.before, map.after ? &*map.after : nullptr, &map.predicted);
    folder.write("maps/volumetric_error.csv", map_csv(data));
    folder.write(map_is_structured(data) ? "maps/volumetric_error.vts" : "maps/volumetric_error.vtu", map_vtk(data));
  }
  if (study.report.page)
    folder.write("report.html", report_page(nlohmann::json(study_report_data(study, result, summary))));
  if (study.report.facts) {
    folder.write("customer-report.html", customer_page(study_customer_report(study, result)));
  }
  if (study.report.facts && !study.report.facts->laboratory.empty()) {
    folder.write("calibration-certificate.xml", study_certificate(study, result));
  }
  if (!ready.customer_pdf.empty()) folder.write("customer-report.pdf", ready.customer_pdf);
  folder.commit();
  return summary_text;
}

}  // namespace abbe
