#include "reproduce/liu_folder.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "abbe/formats/json_text.h"
#include "abbe/formats/ply_file.h"
#include "abbe/formats/results_folder.h"
#include "abbe/formats/scan_plan_file.h"
#include "reproduce/liu_machine.h"
#include "scan/plan_page.h"

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
  parts.deviation.assign(deviation.distances.begin(), deviation.distances.end());
  return ply_bytes(parts);
}

std::string mesh_ply(const TriangleMesh& mesh) {
  PlyParts parts{mesh.vertices};
  parts.triangles = mesh.triangles;
  return ply_bytes(parts);
}

}  // namespace

void write_liu_folder(const LiuResults& results, const std::filesystem::path& folder) {
  ResultsFolder out(folder);
  out.write("summary.json", json_text(liu_json(results)));
  for (const LiuUnitResults& unit : results.units) {
    if (unit.unit != LiuUnit::micrometre) continue;
    for (const LiuMeasuredPart& part : unit.parts) {
      const std::string name = file_name(part.model.name);
      const std::filesystem::path place = name;
      out.write(place / "part.ply", mesh_ply(part.model.mesh));
      out.write(place / "path.csv", scan_plan_csv(results.machine, part.plan));
      out.write(place / "path.ngc",
                scan_plan_program(results.machine, part.plan, "scan of " + name + " on " + results.machine.name));
      out.write(place / "coverage.ply", scan_coverage_ply(part.plan));
      out.write(place / "plan.json", json_text(scan_plan_summary(results.machine, part.plan, part.model.name)));
      out.write(place / "plan.html",
                scan_plan_page(results.machine, part.model.mesh, part.plan,
                               liu_plan_options(part.model, liu_clamping(unit.unit)), part.model.name));
      out.write(place / "before.ply", points_ply(part.measurement.before));
      out.write(place / "after.ply", points_ply(part.measurement.after));
    }
  }
  out.commit();
}

}  // namespace abbe
