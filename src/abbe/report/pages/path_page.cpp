#include "abbe/report/pages/path_page.h"

#include <nlohmann/json.hpp>

#include "abbe/report/evaluations/machine_json.h"
#include "abbe/report/pages/evaluation_data.h"
#include "abbe/report/report.h"

namespace abbe {

PathPicture path_picture(const Machine& machine, const ToolPath& path,
                         const std::vector<std::vector<double>>& commands) {
  PathPicture picture;
  picture.title = "Tool path";
  double time = 0, length = 0;
  bool has_rapid = false;
  for (std::size_t n = 0; n < path.steps.size(); ++n) {
    const ToolPathStep& step = path.steps[n];
    const RigidTransform pose =
        nominal_workpiece_from_tool(machine, std::span(step.command).first(machine.axes.size()));
    DrawnMove move;
    std::copy(commands[n].begin(), commands[n].end(), move.command.begin());
    move.point = pose.translation;
    move.direction = pose.rotation * machine.tool_direction;
    move.working = step.working;
    if (step.working) {
      if (step.feed > 0) time += step.length / step.feed;
      length += step.length;
      move.feed = 60 * step.feed;
    } else {
      has_rapid = true;
    }
    time += step.dwell;
    move.time = time;
    move.length = length;
    picture.moves.push_back(move);
  }
  if (has_rapid) picture.note = "Time: moves at work at their feeds, and dwells; rapid moves are not in it.";
  return picture;
}

std::string path_page(const std::string& title, const Machine& machine,
                      const std::vector<std::pair<std::string, std::string>>& facts, const PathPicture& path,
                      const std::optional<SurfacePicture>& part) {
  EvaluationReport report;
  report.kind = "path";
  report.title = title;
  report.standard = machine.name;
  report.facts = facts;
  report.page = nlohmann::json::object();
  report.page["path"] = path_data(machine, path);
  report.page["machine"] = report_machine(machine);
  if (part) report.page["surface"] = surface_data(*part, nullptr);
  return report_page(evaluation_data(report));
}

}  // namespace abbe
