#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "abbe/errors/error_set.h"
#include "abbe/formats/errors_file.h"
#include "abbe/formats/input_error.h"
#include "abbe/formats/json_text.h"
#include "abbe/formats/machine_file.h"
#include "abbe/machine/axis_unit.h"
#include "abbe/machine/drawing.h"
#include "abbe/machine/machine_check.h"
#include "check_frozen.h"
#include "check_geometry.h"
#include "command.h"
#include "errors_for_use.h"
#include "exit_code.h"
#include "options.h"

namespace abbe {
namespace {

std::vector<std::string> motion_names(const Machine& machine, std::size_t axis) {
  std::vector<std::string> names;
  for (int k = 0; k < kComponentCount; ++k) {
    names.push_back(error_motion_name(machine, axis, static_cast<Component>(k)));
  }
  return names;
}

std::vector<std::string> location_names(const Machine& machine, std::size_t axis) {
  std::vector<std::string> names;
  for (int k = 0; k < kComponentCount; ++k) {
    const Component component = static_cast<Component>(k);
    if (location_error_is_valid(machine.axes[axis], component)) {
      names.push_back(location_error_name(machine, axis, component));
    }
  }
  return names;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

std::string travel_text(const Axis& axis) {
  if (axis.endless) return "endless";
  const double unit = position_unit(axis);
  return fmt::format("{:g} .. {:g} {}", axis.travel_min / unit, axis.travel_max / unit, position_suffix(axis));
}

nlohmann::ordered_json machine_json(const Machine& machine) {
  nlohmann::ordered_json json;
  json["name"] = machine.name;
  json["chain"] = machine.chain();
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Axis& axis = machine.axes[i];
    const bool rotary = axis.kind == AxisKind::rotary;
    nlohmann::ordered_json entry;
    entry["name"] = axis.name;
    entry["kind"] = rotary ? "rotary" : "linear";
    entry["side"] = axis.side == ChainSide::workpiece ? "workpiece" : "tool";
    entry["primed"] = axis.primed;
    entry["direction"] = {axis.direction.x(), axis.direction.y(), axis.direction.z()};
    entry["point_mm"] = {axis.point.x(), axis.point.y(), axis.point.z()};
    entry["endless"] = axis.endless;
    if (!axis.endless) {
      const double unit = position_unit(axis);
      entry[std::string("travel_") + position_suffix(axis)] = {axis.travel_min / unit, axis.travel_max / unit};
    }
    entry["error_motions"] = motion_names(machine, i);
    entry["location_errors"] = location_names(machine, i);
    json["axes"].push_back(entry);
  }
  json["notes"] = find_remarks(machine);
  return json;
}

void print_machine(const Machine& machine) {
  if (!machine.description.empty()) fmt::print("{}\n\n", machine.description);
  fmt::print("{}\n", draw_machine(machine));
  fmt::print("{:<5} {:<7} {:<10} {:<24} {:<26} {}\n", "axis", "kind", "carries", "direction", "point / mm", "travel");
  for (const Axis& axis : machine.axes) {
    const auto triple = [](const Eigen::Vector3d& v) { return fmt::format("({:g}, {:g}, {:g})", v.x(), v.y(), v.z()); };
    fmt::print("{:<5} {:<7} {:<10} {:<24} {:<26} {}\n", axis.name + (axis.primed ? "'" : ""),
               axis.kind == AxisKind::rotary ? "rotary" : "linear",
               axis.side == ChainSide::workpiece ? "workpiece" : "tool", triple(axis.direction), triple(axis.point),
               travel_text(axis));
  }
  std::size_t motions = 0, locations = 0;
  fmt::print("\nerror motions (ISO 230-1, ISO 230-7) and location errors\n");
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const std::vector<std::string> names = location_names(machine, i);
    fmt::print("{:<5} {}   {}\n", machine.axes[i].name, joined(motion_names(machine, i)), joined(names));
    motions += kComponentCount;
    locations += names.size();
  }
  fmt::print("{} error motions, {} location errors\n", motions, locations);
  for (const std::string& remark : find_remarks(machine)) fmt::print("note: {}\n", remark);
}

void refuse_if_given(const Option* option, const char* why) {
  if (option->count() > 0) throw InputError({.field = option->get_name()}, why, "no such option");
}

}  // namespace

void add_check_command(CommandLine& line) {
  struct Options {
    std::string file, errors;
    bool json = false;
    GeometryCheckOptions geometry;
  };
  auto options = std::make_shared<Options>();
  Subcommand* command = line.add(
      "check", "Validate a machine file, a frozen compensation, a mesh or a point cloud, and show its contents",
      "  abbe check examples/machines/trunnion-mill.machine.toml\n"
      "  abbe check examples/machines/aguado.machine.toml --errors examples/aguado/results/aguado/errors.toml\n"
      "  abbe check examples/parts/wedge.stl --unit mm\n"
      "A frozen compensation (abbe compensate freeze) is refused here as a controller would refuse it.\n"
      "Exit code 1: the inside and outside of a mesh cannot be told apart everywhere (turned or branching edges,\n"
      "duplicate triangles, inside out), or faces were left out. Holes are counted; they are not an error.");
  command
      ->add_option("file", options->file,
                   "Machine file (*.machine.toml), frozen compensation (.abbec), mesh (.stl .ply .obj .step .stp) or "
                   "point cloud (.xyz .asc .pts .csv .ply)")
      ->required();
  const Option* errors_option =
      command->add_option("--errors", options->errors, "Also validate an errors file of this machine (*.errors.toml)");
  command->add_flag("--json", options->json, "Print JSON for programs");
  const Option* unit =
      command->add_option("--unit", options->geometry.unit,
                          "Unit of a mesh or point cloud whose file states none: mm (default), m or inch");
  options->geometry.step.add_to(command);
  command->callback([&line, options, errors_option, unit] {
    line.run = [options, errors_option, unit]() -> int {
      if (is_geometry_file(options->file)) {
        refuse_if_given(errors_option, "a mesh or a point cloud has no error parameters");
        options->geometry.file = options->file;
        options->geometry.json = options->json;
        return check_geometry(options->geometry);
      }
      if (is_frozen_file(options->file)) {
        const char* const why = "a frozen compensation contains its errors and units";
        for (const Option* const option : {errors_option, unit}) refuse_if_given(option, why);
        options->geometry.step.refuse(why);
        return check_frozen(options->file, options->json);
      }
      refuse_if_given(unit, "a machine file states its units");
      options->geometry.step.refuse("a machine file has no faces");
      const Machine machine = read_machine(options->file);
      nlohmann::ordered_json json = machine_json(machine);
      std::size_t coefficients = 0, terms = 0;
      if (!options->errors.empty()) {
        const ErrorsFile errors = read_errors_and_tell(options->errors, machine);
        terms = errors.errors.motions.size();
        coefficients = errors.errors.parameter_count();
        json["errors"] = {{"motion_terms", terms},
                          {"location_errors", errors.errors.locations.size()},
                          {"parameters", coefficients},
                          {"covariance", errors.covariance.size() > 0},
                          {"distrusted", errors.distrusted}};
      }
      if (options->json) {
        fmt::print("{}", json_text(json));
        return kDone;
      }
      print_machine(machine);
      if (!options->errors.empty()) {
        fmt::print("\n{}: {} terms of error motions, {} parameters\n", options->errors, terms, coefficients);
      }
      return kDone;
    };
  });
}

}  // namespace abbe
