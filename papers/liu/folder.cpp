#include "liu/folder.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/readings/scan_plan_file.h"
#include "abbe/formats/shapes/ply_file.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/report/pages/scan_plan_page.h"
#include "liu/machine.h"

namespace abbe {
namespace {

/// "sphere, 25 %" -> "sphere-25"
std::string file_name(const std::string& part) {
  std::string name;
  for (const char c : part) {
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) {
      name += c;
    } else if (!name.empty() && name.back() != '-') {
      name += '-';
    }
  }
  while (!name.empty() && name.back() == '-') name.pop_back();
  return name;
}

std::string points_ply(const LiuDeviation& deviation) {
  PlyParts parts{deviation.registered_points};
  parts.deviation = {deviation.distances.data(), static_cast<std::size_t>(deviation.distances.size())};
  return ply_bytes(parts);
}

std::string mesh_ply(const TriangleMesh& mesh) {
  PlyParts parts{mesh.vertices};
  parts.triangles = mesh.triangles;
  return ply_bytes(parts);
}

/// Axis positions and indications.
std::string readings_csv(const Machine& machine, const LiuScan& scan) {
  std::string text;
  for (const Axis& axis : machine.axes) text += axis.name + "_" + position_suffix(axis) + ",";
  text += "indication_um\n";
  for (std::size_t k = 0; k < scan.indication.size(); ++k) {
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      text += shortest_text(scan.positions.axis[i][k] / position_unit(machine.axes[i])) + ',';
    }
    text += shortest_text(1e3 * scan.indication[k]) + '\n';
  }
  return text;
}

}  // namespace

void write_liu_study(const LiuResults& results, ResultsFolder& out) {
  const Machine& machine = results.machine;
  const std::filesystem::path study = "study";
  out.write(study / "liu-scanner.machine.toml", machine_text(machine));
  out.write(
      study / "table-3.errors.toml",
      errors_text(machine, {liu_errors(machine, LiuUnit::micrometre), {}, {{"source", "Table 3, shifts in um"}}}));
  if (results.figures.complete()) {
    const LiuCampaign& campaign = results.figures.micrometres().noisy;
    out.write(study / "calibrated.errors.toml",
              errors_text(machine, {campaign.c.errors, {}, {{"source", "simulated readings, noise of Table 2"}}}));
    out.write(study / "clamping-readings.csv", readings_csv(machine, campaign.clamping.readings));
  }
  for (const LiuUnitResults& unit : results.units) {
    if (unit.unit != LiuUnit::micrometre) continue;
    for (const LiuMeasuredPart& part : unit.parts) {
      const std::string name = file_name(part.model.name);
      const std::filesystem::path place = study / name;
      out.write(place / "part.ply", mesh_ply(part.model.mesh));
      out.write(place / "path.csv", scan_plan_csv(machine, part.plan));
      out.write(place / "path.ngc", scan_plan_program(machine, part.plan, "scan of " + name + " on " + machine.name));
      out.write(place / "coverage.ply", scan_coverage_ply(part.plan));
      out.write(place / "plan.json", json_text(scan_plan_summary(machine, part.plan, part.model.name)));
      out.write(place / "plan.html",
                scan_plan_page(machine, part.model.mesh, part.plan,
                               liu_plan_options(part.model, liu_clamping(unit.unit)), part.model.name));
      out.write(place / "before.ply", points_ply(part.measurement.before));
      out.write(place / "after.ply", points_ply(part.measurement.after));
    }
  }
}

}  // namespace abbe
