#include <fmt/format.h>

#include <numbers>

#include "abbe/formats/json_text.h"
#include "abbe/formats/results_folder.h"
#include "abbe/formats/study_file.h"
#include "abbe/report/svg_plot.h"
#include "command.h"
#include "study/planning.h"

namespace abbe {
namespace {

std::string plan_csv(const Study& study, const StudyPlan& result) {
  std::string text = "# " + study.name + ": readings in the order in which they are to be taken\n";
  for (const Axis& axis : study.machine.axes)
    text += fmt::format("{}_{},", axis.name, axis.kind == AxisKind::rotary ? "deg" : "mm");
  text += study.setups.size() > 1 ? "setup,station,reflector\n" : "station,reflector\n";
  for (const SightReading& reading : result.readings) {
    for (std::size_t i = 0; i < reading.pose.size(); ++i)
      text += fmt::format(
          "{:.6f},", reading.pose[i] * (study.machine.axes[i].kind == AxisKind::rotary ? 180 / std::numbers::pi : 1));
    const Setup& setup = study.setups[reading.setup];
    if (study.setups.size() > 1) text += setup.name + ",";
    text += fmt::format("{},{}\n", setup.stations[reading.station].name, setup.reflectors[reading.reflector].name);
  }
  return text;
}

std::string plan_svg(const Study& study, const StudyPlan& result) {
  XyPlot plot(study.name + ": how many readings are enough", "readings",
              "predicted volumetric standard uncertainty in um");
  std::vector<PlotPoint> curve;
  for (const PlanPoint& point : result.curve)
    if (point.determined) curve.push_back({static_cast<double>(point.readings), 1e3 * point.uncertainty});
  plot.include_y(0);
  plot.line(curve, {PlotColour::first, 1.6, false, 1}, "");
  plot.points(curve, Marker::circle, {PlotColour::first, 1.6, false, 1}, "chosen readings");
  if (result.enough < result.curve.size()) {
    const PlanPoint& enough = result.curve[result.enough];
    plot.points({{static_cast<double>(enough.readings), 1e3 * enough.uncertainty}}, Marker::up,
                {PlotColour::third, 1.6, false, 1}, "enough");
  }
  if (result.same_grid)
    plot.points({{static_cast<double>(result.same_grid->value.readings), 1e3 * result.same_grid->value.uncertainty}},
                Marker::cross, {PlotColour::second, 1.6, false, 1}, "best regular grid");
  return plot.svg();
}

std::string grid_text(const Study& study, const GridPoint& grid) {
  std::string text;
  for (std::size_t i = 0; i < grid.positions.size(); ++i) {
    if (grid.positions[i] > 1)
      text += fmt::format("{}{} {}", text.empty() ? "" : " x ", study.machine.axes[i].name, grid.positions[i]);
  }
  return text +
         (grid.sights == SightsPerPose::every ? ", every sight at each pose" : ", one sight at each pose in turn");
}

nlohmann::ordered_json grid_json(const Study& study, const GridPoint& grid) {
  nlohmann::ordered_json positions;
  for (std::size_t i = 0; i < grid.positions.size(); ++i) positions[study.machine.axes[i].name] = grid.positions[i];
  return {{"positions", positions},
          {"sights", grid.sights == SightsPerPose::every ? "every" : "in turn"},
          {"readings", grid.value.readings},
          {"uncertainty_um", 1e3 * grid.value.uncertainty}};
}

nlohmann::ordered_json plan_json(const Study& study, const StudyPlan& result) {
  const char* const goals[] = {"volumetric", "determinant", "parameters"};
  nlohmann::ordered_json json;
  json["format"] = "abbe-plan/1";
  json["study"] = study.name;
  json["machine"] = study.machine.name;
  json["status"] = status_text(result.plan.status);
  json["goal"] = goals[static_cast<int>(study.planning->goal)];
  json["candidates"] = result.candidates;
  json["without_line_of_sight"] = result.hidden;
  json["forbidden_poses"] = result.forbidden;
  json["parameters"] = result.parameters;
  json["seen_directions"] = result.seen;
  if (result.plan.status != PlanningStatus::done) return json;
  json["readings"] = result.readings.size();
  json["time_s"] = result.time;
  json["predicted_volumetric_uncertainty_um"] = 1e3 * result.uncertainty;
  json["largest_unseen_part_of_a_prediction"] = result.unseen_part;
  json["exchanges"] = result.plan.exchanges;
  for (const PlanPoint& point : result.curve) {
    nlohmann::ordered_json entry = {{"readings", point.readings}, {"determined", point.determined}};
    if (point.determined) entry["uncertainty_um"] = 1e3 * point.uncertainty;
    json["curve"].push_back(entry);
  }
  if (result.enough < result.curve.size()) json["enough_readings"] = result.curve[result.enough].readings;
  json["enough"] = result.enough_words;
  json["grids_tried"] = result.grids_tried;
  if (result.same_grid) {
    json["grid_of_the_same_number"] = grid_json(study, *result.same_grid);
    json["gain"] = result.same_grid->value.uncertainty / result.uncertainty;
  }
  if (result.equal_grid) {
    json["grid_of_the_same_uncertainty"] = grid_json(study, *result.equal_grid);
    json["grid_readings_per_reading"] =
        static_cast<double>(result.equal_grid->value.readings) / static_cast<double>(result.readings.size());
  }
  if (result.largest_grid) json["largest_grid_tried"] = grid_json(study, *result.largest_grid);
  return json;
}

void print_grids(const Study& study, const StudyPlan& result) {
  fmt::print("\nagainst regular grids ({} tried, line of sight respected; in what the candidates can see)\n",
             result.grids_tried);
  if (result.same_grid) {
    const GridPoint& grid = *result.same_grid;
    fmt::print("  about the same number: {} readings ({}): {:.3f} um, {:.2f} times the plan's\n", grid.value.readings,
               grid_text(study, grid), 1e3 * grid.value.uncertainty, grid.value.uncertainty / result.uncertainty);
  } else {
    fmt::print(
        "  about the same number: no grid determines everything (too few positions of an axis, or harmonics\n"
        "  that equal steps cannot tell apart), so there is no ratio\n");
  }
  if (result.equal_grid) {
    const GridPoint& grid = *result.equal_grid;
    fmt::print("  the same uncertainty: {} readings ({}): {:.3f} um, {:.2f} times the plan's number\n",
               grid.value.readings, grid_text(study, grid), 1e3 * grid.value.uncertainty,
               static_cast<double>(grid.value.readings) / static_cast<double>(result.readings.size()));
  } else if (result.largest_grid) {
    const GridPoint& grid = *result.largest_grid;
    fmt::print("  the same uncertainty: not reached by {} readings ({}): {:.3f} um\n", grid.value.readings,
               grid_text(study, grid), 1e3 * grid.value.uncertainty);
  } else {
    fmt::print("  the same uncertainty: no grid tried determines everything\n");
  }
}

void print_plan(const Study& study, const StudyPlan& result) {
  fmt::print("{}: {}   ({})\n", study.name, study.machine.name, study.machine.chain());
  fmt::print("{} candidates; {} sights without a line of sight and {} poses in forbidden boxes left out\n",
             result.candidates, result.hidden, result.forbidden);
  fmt::print("{} parameters, of which the candidates see {} directions\n", result.parameters, result.seen);
  if (result.plan.status != PlanningStatus::done) {
    fmt::print("no plan: {}\n", status_text(result.plan.status));
    return;
  }
  if (result.unseen_part > 1e-6)
    fmt::print("note: {:.2g} % of a prediction depends on directions that no candidate sees; they are left out\n",
               100 * result.unseen_part);
  fmt::print("\n{} readings in {:.0f} min\n", result.readings.size(), result.time / 60);
  if (study.planning->time > 0 && result.time > study.planning->time)
    fmt::print("warning: this is more than the {:.0f} min allowed\n", study.planning->time / 60);
  fmt::print("predicted volumetric standard uncertainty (root mean square): {:.3f} um\n", 1e3 * result.uncertainty);
  fmt::print("\nhow many are enough: {}\n", result.enough_words);
  for (std::size_t k = 0; k < result.curve.size(); ++k) {
    const PlanPoint& point = result.curve[k];
    const char* const mark = k == result.enough ? "   <- enough" : "";
    if (point.determined)
      fmt::print("  {:>6} readings {:>10.3f} um{}\n", point.readings, 1e3 * point.uncertainty, mark);
    else
      fmt::print("  {:>6} readings   do not determine everything\n", point.readings);
  }
  print_grids(study, result);
}

}  // namespace

void add_plan_command(CommandLine& line) {
  struct Options {
    std::string study, output, plot;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = line.add("plan", "Choose the readings that determine a machine's errors best",
                               "  abbe plan my.study.toml -o poses.csv --svg curve.svg");
  command->add_option("study", options->study, "Study file (*.study.toml) with tables [plan] and [identify]")
      ->required();
  command->add_option("-o,--output", options->output, "Readings to take, in an order of short travel (*.csv)");
  command->add_option("--svg", options->plot, "Plot of uncertainty against number of readings (*.svg)");
  command->add_flag("--json", options->json, "Print JSON for programs");
  command->callback([&line, options] {
    line.run = [options]() -> int {
      const Study study = read_study(options->study);
      StudyPlan result;
      {
        Progress progress("planning");
        result = plan_study(study, [&](double share) { progress(static_cast<std::size_t>(1000 * share), 1000); });
      }
      const bool done = result.plan.status == PlanningStatus::done;
      if (done && !options->output.empty()) write_file_atomically(options->output, plan_csv(study, result));
      if (done && !options->plot.empty()) write_file_atomically(options->plot, plan_svg(study, result));
      if (options->json) {
        fmt::print("{}\n", json_text(plan_json(study, result)));
      } else {
        print_plan(study, result);
        if (done && !options->output.empty()) fmt::print("\n{} written\n", options->output);
      }
      return done ? kDone : kNegative;
    };
  });
}

}  // namespace abbe
