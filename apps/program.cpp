#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "abbe/formats/files/file_name.h"
#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/nc/path_program.h"
#include "abbe/formats/text/ascii_letters.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/geometry/angle_units.h"
#include "abbe/study/planned_measurement.h"
#include "axis_option.h"
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
  int trigger_number = -1;
  double dwell_s = 2, reading_s = 0, pulse_s = 0.1, feed_mm_per_min = 0, clearance_mm = 0, rotary_speed_deg = 30;
  ToolShape tool;
  double linear_speed = 100;
  bool shorten = false, machine_coordinates = false, dry_run = false, json = false;
  StepReading step;
  BallProbing ball;
};

/// Carrier and the rest of "table=...".
struct ObstacleText {
  Obstacle obstacle;
  std::string rest;
};

ObstacleText obstacle_text(const Machine& machine, const std::string& option, const std::string& text,
                           const std::string& form) {
  const std::size_t equals = text.find('=');
  const std::string carrier = text.substr(0, equals);
  ObstacleText result;
  if (carrier == "base") {
    result.obstacle.carrier = ObstacleCarrier::base;
  } else if (carrier == "table") {
    result.obstacle.carrier = ObstacleCarrier::table;
  } else {
    result.obstacle.carrier = ObstacleCarrier::axis;
    result.obstacle.axis = machine.find_axis(carrier);
  }
  if (equals == std::string::npos || result.obstacle.axis == Machine::npos) {
    throw InputError({.field = option + " " + text}, "not understood",
                     form + ", where ON is base, table or an axis of " + machine.chain());
  }
  result.rest = text.substr(equals + 1);
  return result;
}

Obstacle box_obstacle(const Machine& machine, const std::string& text, std::size_t number) {
  const std::string option = "--obstacle-box-mm", form = "ON=X0,Y0,Z0,X1,Y1,Z1 in mm";
  ObstacleText read = obstacle_text(machine, option, text, form);
  std::array<double, 6> corners{};
  std::string_view rest = read.rest;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const std::size_t comma = rest.find(',');
    const bool is_last = k + 1 == corners.size();
    if (is_last != (comma == std::string_view::npos) ||
        parse_number(rest.substr(0, comma), 0, corners[k]) != NumberProblem::none) {
      throw InputError({.field = option + " " + text}, "not six numbers with commas between them", form);
    }
    if (!is_last) rest.remove_prefix(comma + 1);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (corners[k] != corners[k + 3]) continue;
    throw InputError({.field = option + " " + text}, "a box without volume", "two opposite corners, " + form);
  }
  read.obstacle.name = fmt::format("box {}", number);
  read.obstacle.mesh = box_mesh({corners[0], corners[1], corners[2]}, {corners[3], corners[4], corners[5]});
  return std::move(read.obstacle);
}

std::vector<Obstacle> read_obstacles(const ProgramCommand& command, const Machine& machine) {
  std::vector<Obstacle> obstacles;
  for (const std::string& text : command.boxes) {
    obstacles.push_back(box_obstacle(machine, text, obstacles.size() + 1));
  }
  std::vector<ObstacleText> meshes;
  std::vector<std::filesystem::path> files;
  for (const std::string& text : command.meshes) {
    meshes.push_back(obstacle_text(machine, "--obstacle-mesh", text, "ON=FILE"));
    files.emplace_back(meshes.back().rest);
  }
  command.step.require_step_among(files);
  for (ObstacleText& mesh : meshes) {
    mesh.obstacle.name = file_name(mesh.rest);
    mesh.obstacle.mesh =
        command.step.read_whole(mesh.rest, "all faces of the obstacle, because the tool must keep clear of them").mesh;
    obstacles.push_back(std::move(mesh.obstacle));
  }
  return obstacles;
}

/// Name of a program for controls that want one: capitals, digits and underlines of the name of its file.
std::string program_name(const std::string& file) {
  std::string name;
  for (const char c : std::filesystem::path(file).stem().string()) {
    name += is_letter(c) || is_digit(c) ? upper_case(c) : '_';
  }
  constexpr std::size_t kLongestName = 24;
  return name.empty() ? "MEASURE" : name.substr(0, kLongestName);
}

MeasuringProgramOptions program_options(const ProgramCommand& command, const Machine& machine) {
  MeasuringProgramOptions options;
  options.dialect = *nc_dialect(command.dialect);
  options.name = program_name(command.output);
  options.words = axis_words(machine, command.words, "--word");
  if (command.decimals) options.decimals = static_cast<int>(*command.decimals);
  options.feed = command.feed_mm_per_min / 60;
  options.dwell = command.dwell_s;
  options.reading = command.reading_s;
  options.pulse = command.pulse_s;
  options.trigger = command.trigger == "output"       ? NcTrigger::output
                    : command.trigger == "m-function" ? NcTrigger::m_function
                                                      : NcTrigger::dwell;
  if (options.trigger != NcTrigger::dwell && command.trigger_number < 0) {
    throw InputError(
        {.field = "--trigger-number"}, "missing",
        options.trigger == NcTrigger::output ? "the number of the output" : "the number of the M function");
  }
  options.number = command.trigger_number;
  options.machine_coordinates = command.machine_coordinates;
  return options;
}

MeasurementRequest request_of(const ProgramCommand& command) {
  MeasurementRequest request;
  request.machine = read_machine(command.machine);
  request.program = program_options(command, request.machine);
  request.readings_file = command.readings;
  request.list = read_reading_list(command.readings, request.machine);
  request.sections = command.stop_at == "none"     ? MeasurementSections::none
                     : command.stop_at == "setups" ? MeasurementSections::setups
                                                   : MeasurementSections::stations;
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

void tell_written(const ProgramCommand& command, bool written, const std::string& other) {
  if (written) fmt::print("{} written\n", command.output);
  if (written && !other.empty()) fmt::print("{} written\n", other);
  if (command.dry_run) fmt::print("dry run: nothing written\n");
}

ProbingRequest probing_request(const ProgramCommand& command) {
  if (command.dialect != "linuxcnc") {
    throw InputError({.field = "--probe-ball-mm"}, "touches are written for LinuxCNC only", "--dialect linuxcnc");
  }
  const MeasurementRequest measurement = request_of(command);
  ProbingRequest request;
  request.machine = measurement.machine;
  request.list = measurement.list;
  request.readings_file = command.readings;
  request.obstacles = measurement.obstacles;
  request.tool = measurement.tool;
  request.ways = measurement.ways;
  request.program.words = measurement.program.words;
  request.program.decimals = measurement.program.decimals.value_or(request.program.decimals);
  request.program.feed = measurement.program.feed;
  request.program.dwell = command.dwell_s;
  command.ball.take(request);
  return request;
}

int run_ball_probing(const ProgramCommand& command) {
  const PlannedProbing planned = plan_probing(probing_request(command));
  const bool written = planned.refused.empty() && !command.dry_run;
  const std::string& touches = command.ball.touches_file();
  if (written) {
    write_file_atomically(command.output, planned.program);
    if (!touches.empty()) write_file_atomically(touches, planned_touches_csv(planned.machine, planned.touches));
  }
  if (command.json) {
    fmt::print("{}", json_text(planned_probing_json(planned)));
  } else {
    fmt::print("{}", planned_probing_text(planned));
    tell_written(command, written, touches);
  }
  if (planned.refused.empty()) return kDone;
  std::fflush(stdout);
  tell("abbe: {}; nothing written\n", planned.refused);
  return kNegative;
}

int run_program_command(const ProgramCommand& command) {
  if (command.output.empty() && !command.dry_run) {
    throw InputError({.field = "-o"}, "missing", "a file for the program, or --dry-run");
  }
  if (command.ball.is_wanted()) return run_ball_probing(command);
  const PlannedMeasurement planned = plan_measurement(request_of(command));
  const bool written = planned.refused.empty() && !command.dry_run;
  if (written) {
    write_file_atomically(command.output, planned.program);
    if (!command.sheet.empty()) write_file_atomically(command.sheet, planned_measurement_sheet(planned));
  }
  if (command.json) {
    fmt::print("{}", json_text(planned_measurement_json(planned)));
  } else {
    fmt::print("{}", planned_measurement_text(planned));
    tell_written(command, written, command.sheet);
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
                    "Moves past all zero offsets (G53, SUPA, M91), where the zero of the machine file is that of the "
                    "machine");
  command->add_option("--feed-mm-per-min", options->feed_mm_per_min, "Move at this feed (default: rapid traverse)")
      ->check(positive_number());
  const auto seconds = [&](const char* name, double& value, const char* words) {
    command->add_option(name, value, words)->check(in_range(0.0, 3600.0))->capture_default_str();
  };
  seconds("--dwell-s", options->dwell_s, "Standing still before the trigger");
  seconds("--reading-s", options->reading_s, "Standing still after the trigger, while the instrument reads");
  command->add_option("--trigger", options->trigger, "What tells the instrument that the machine stands")
      ->check(one_of({"dwell", "m-function", "output"}))
      ->capture_default_str();
  command->add_option("--trigger-number", options->trigger_number, "Number of the M function or of the output")
      ->check(in_range(0, 99999));
  seconds("--pulse-s", options->pulse_s, "How long the output is on");
  command->add_option("--stop-at", options->stop_at, "Stop for the operator at every station, every set-up, or nowhere")
      ->check(one_of({"stations", "setups", "none"}))
      ->capture_default_str();
  command->add_flag("--shorten", options->shorten,
                    "Readings between two stops in an order of short travel (default: that of the file)");
  command->add_option("--start", options->start,
                      "Where an axis stands before the program, AXIS_unit=position; repeatable, for all axes");
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
  length("--clearance-mm", options->clearance_mm, "Retract along the tool by this where the straight way is not clear");
  command->add_option(
      "--clear-at", options->clear_at,
      "Position at which an axis is clear of everything, AXIS_unit=position; tried as well; repeatable");
  command->add_option("--linear-speed-mm-per-s", options->linear_speed, "Rapid traverse of linear axes, for the time")
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
