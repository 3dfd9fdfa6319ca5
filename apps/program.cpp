#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "abbe/formats/files/file_name.h"
#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/machine/axis_option.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/machine/obstacle_option.h"
#include "abbe/formats/nc/path_program.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/study/planning/planned_measurement.h"
#include "ball_probing.h"
#include "command.h"
#include "exit_code.h"
#include "machine_options.h"
#include "messages.h"
#include "options.h"
#include "step_reading.h"

namespace abbe {
namespace {

struct ProgramCommand {
  std::string readings, machine, output, sheet, dialect, trigger = "dwell", stop_at = "stations";
  std::vector<std::string> words, start, boxes, meshes, clear_at;
  std::optional<std::size_t> decimals;
  int trigger_number = -1;  ///< below zero: not given
  double dwell_s = 2, reading_s = 0, pulse_s = 0.1, feed_mm_per_min = 0, clearance_mm = 0, rotary_speed_deg = 30;
  ToolShape tool;
  double linear_speed = 100;
  bool shorten = false, machine_coordinates = false, dry_run = false, json = false;
  StepReading step;
  BallProbing ball;
};

std::vector<Obstacle> read_obstacles(const ProgramCommand& command, const Machine& machine) {
  std::vector<Obstacle> obstacles;
  for (const std::string& text : command.boxes) {
    obstacles.push_back(box_obstacle_option(machine, "--obstacle-box-mm", text, obstacles.size() + 1));
  }
  std::vector<ObstacleOption> meshes;
  std::vector<std::filesystem::path> files;
  for (const std::string& text : command.meshes) {
    meshes.push_back(obstacle_option(machine, "--obstacle-mesh", text, "ON=FILE"));
    files.emplace_back(meshes.back().contents);
  }
  command.step.require_step_among(files);
  for (ObstacleOption& mesh : meshes) {
    mesh.obstacle.name = file_name(mesh.contents);
    mesh.obstacle.mesh =
        command.step.read_whole(mesh.contents, "all faces of the obstacle, because the tool must keep clear of them")
            .mesh;
    obstacles.push_back(std::move(mesh.obstacle));
  }
  return obstacles;
}

MeasuringProgramOptions program_options(const ProgramCommand& command, const Machine& machine) {
  MeasuringProgramOptions options;
  options.dialect = *nc_dialect(command.dialect);
  options.name = nc_program_name(command.output);
  options.words = axis_words(machine, command.words, "--word");
  if (command.decimals) options.decimals = static_cast<int>(*command.decimals);
  options.feed = command.feed_mm_per_min / 60;
  options.dwell = command.dwell_s;
  options.reading = command.reading_s;
  options.pulse = command.pulse_s;
  options.trigger = *nc_trigger(command.trigger);
  if (command.trigger_number >= 0) options.number = command.trigger_number;
  options.machine_coordinates = command.machine_coordinates;
  return options;
}

MeasurementRequest request_of(const ProgramCommand& command) {
  MeasurementRequest request;
  request.machine = read_machine(command.machine);
  request.program = program_options(command, request.machine);
  request.readings_file = command.readings;
  request.list = read_reading_list(command.readings, request.machine);
  request.sections = *measurement_sections(command.stop_at);
  request.shorten = command.shorten;
  request.start = axis_options(request.machine, "--start", command.start);
  request.obstacles = read_obstacles(command, request.machine);
  request.tool = command.tool;
  request.ways.clearance = command.clearance_mm;
  for (const HeldAxis& at : axis_options(request.machine, "--clear-at", command.clear_at)) {
    request.ways.clear_at.emplace_back(at.axis, at.position);
  }
  request.linear_speed = command.linear_speed;
  request.rotary_speed = command.rotary_speed_deg * kDegree;
  return request;
}

/// What is written and printed of a program.
struct ProgramOutcome {
  std::string program, refused, text;
  nlohmann::ordered_json json;
  std::string other_file, other;  ///< sheet or touches; empty: not wanted
};

ProgramOutcome measuring_outcome(const ProgramCommand& command) {
  const PlannedMeasurement planned = plan_measurement(request_of(command));
  return {planned.program,
          planned.refused,
          planned_measurement_text(planned),
          planned_measurement_json(planned),
          command.sheet,
          command.sheet.empty() ? "" : planned_measurement_sheet(planned)};
}

ProgramOutcome probing_outcome(const ProgramCommand& command) {
  ProbingRequest request = probing_request(request_of(command));
  command.ball.take(request);
  const PlannedProbing planned = plan_probing(request);
  return {planned.program,
          planned.refused,
          planned_probing_text(planned),
          planned_probing_json(planned),
          command.ball.touches_file(),
          planned_touches_csv(planned.machine, planned.touches)};
}

int run_program_command(const ProgramCommand& command) {
  if (command.output.empty() && !command.dry_run) {
    throw InputError({.field = "-o"}, "missing", "a file for the program, or --dry-run");
  }
  const ProgramOutcome planned = command.ball.is_wanted() ? probing_outcome(command) : measuring_outcome(command);
  std::vector<std::string> written;
  if (planned.refused.empty() && !command.dry_run) {
    write_file_atomically(command.output, planned.program);
    written.push_back(command.output);
    if (!planned.other_file.empty()) {
      write_file_atomically(planned.other_file, planned.other);
      written.push_back(planned.other_file);
    }
  }
  if (command.json) {
    fmt::print("{}", json_text(planned.json));
  } else {
    fmt::print("{}", planned.text);
    for (const std::string& file : written) fmt::print("{} written\n", file);
    if (command.dry_run) fmt::print("dry run: nothing written\n");
  }
  if (planned.refused.empty()) return kDone;
  std::fflush(stdout);
  tell("abbe: {}; nothing written\n", planned.refused);
  return kNegative;
}

}  // namespace

void add_program_command(CommandLine& line) {
  auto options = std::make_shared<ProgramCommand>();
  Subcommand* command = line.add(
      "program", "Write an NC program that drives the machine to the readings of a plan",
      "  abbe program examples/measuring_program/poses.csv --machine examples/machines/trunnion-mill.machine.toml "
      "--dialect linuxcnc -o measure.ngc --sheet measure.html\n"
      "  abbe program examples/measuring_program/poses.csv --machine examples/machines/trunnion-mill.machine.toml "
      "--dialect heidenhain -o measure.h --obstacle-box-mm table=-60,-60,0,60,60,80 --tool-radius-mm 5 "
      "--tool-length-mm 150 --clearance-mm 200\n"
      "  abbe program examples/measuring_program/poses.csv --machine examples/machines/trunnion-mill.machine.toml "
      "--dialect linuxcnc -o probe.ngc --touches touches.csv --probe-ball-mm 80 0 60 12.5 --clearance-mm 150\n\n"
      "The readings: what abbe plan -o writes, or any CSV with a column for each axis (X_mm, C_deg).\n"
      "Exit code 1: a reading or a way to one is not clear of the obstacles; nothing is written.");
  command->add_input_file("readings", options->readings, "Readings to take (*.csv)")->required();
  add_machine(*command, options->machine)->required();
  command->add_option("--dialect", options->dialect, "Control that the program is for")
      ->required()
      ->check(one_of(nc_dialect_names()));
  command->add_output_file("-o,--output", options->output, "Program to write", &options->dry_run);
  command->add_output_file("--sheet", options->sheet, "Sheet for the operator to write (.html), for paper of size A4",
                           &options->dry_run);
  command->add_option("--word", options->words, "Word of an axis in the program, AXIS=WORD (C1=C); repeatable");
  command
      ->add_option("--decimals", options->decimals,
                   "Decimals of mm and degrees in the program (default: 6; heidenhain and siemens 4, fanuc 3)")
      ->check(in_range(1, 9));
  command->add_flag("--machine-coordinates", options->machine_coordinates,
                    "Move in machine coordinates, without zero offsets (G53, SUPA, M91); the zero of the machine file "
                    "must be that of the machine");
  command->add_option("--feed-mm-per-min", options->feed_mm_per_min, "Move at this feed (default: rapid traverse)")
      ->check(positive_number());
  const auto seconds = [&](const char* name, double& value, const char* words) {
    command->add_option(name, value, words)->check(in_range(0.0, 3600.0))->capture_default_str();
  };
  seconds("--dwell-s", options->dwell_s, "Dwell before the trigger");
  seconds("--reading-s", options->reading_s, "Dwell after the trigger, while the instrument reads");
  command->add_option("--trigger", options->trigger, "Signal that tells the instrument that the machine has stopped")
      ->check(one_of(nc_trigger_names()))
      ->capture_default_str();
  command->add_option("--trigger-number", options->trigger_number, "Number of the M function or of the output")
      ->check(in_range(0, 99999));
  seconds("--pulse-s", options->pulse_s, "Duration of the pulse on the output");
  command->add_option("--stop-at", options->stop_at, "Stop for the operator at every station, every set-up, or nowhere")
      ->check(one_of(measurement_section_names()))
      ->capture_default_str();
  command->add_flag("--shorten", options->shorten,
                    "Order the readings between two stops for short travel (default: order of the file)");
  command->add_option("--start", options->start,
                      "Position of an axis before the program, AXIS_unit=position; repeatable, for all axes");
  command->add_option("--obstacle-box-mm", options->boxes,
                      "Box that the tool must not touch, ON=X0,Y0,Z0,X1,Y1,Z1, where ON is base (machine frame), table "
                      "(workpiece frame) or an axis (machine frame, all axes at zero); repeatable");
  command->add_option("--obstacle-mesh", options->meshes,
                      "The same with a mesh, ON=FILE (.stl .ply .obj .step), mm; repeatable");
  options->step.add_to(command);
  const auto length = [&](const char* name, double& value, const char* words) {
    command->add_option(name, value, words)->check(in_range(0.0, 1e5))->capture_default_str();
  };
  length("--tool-radius-mm", options->tool.radius, "Radius kept clear about the tool's line");
  length("--tool-length-mm", options->tool.length,
         "Length of the tool's line from the functional point towards the spindle");
  length("--clearance-mm", options->clearance_mm,
         "Retract along the tool by this distance where the direct way is not clear");
  command->add_option("--clear-at", options->clear_at,
                      "Position at which an axis is clear of all obstacles, AXIS_unit=position; tried too; repeatable");
  command
      ->add_option("--linear-speed-mm-per-s", options->linear_speed,
                   "Rapid traverse of linear axes, to estimate the time")
      ->check(positive_number())
      ->capture_default_str();
  command->add_option("--rotary-speed-deg-per-s", options->rotary_speed_deg, "The same of rotary axes")
      ->check(positive_number())
      ->capture_default_str();
  command->add_flag("--dry-run", options->dry_run, "Report only; write nothing");
  command->add_flag("--json", options->json, "Print JSON for programs");
  options->ball.add_to(command, &options->dry_run);
  command->callback([&line, options] { line.run = [options]() -> int { return run_program_command(*options); }; });
}

}  // namespace abbe
