#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/formats/errors_file.h"
#include "abbe/formats/input_error.h"
#include "abbe/formats/json_text.h"
#include "abbe/formats/machine_file.h"
#include "abbe/formats/map_file.h"
#include "abbe/formats/measurement_file.h"
#include "abbe/formats/results_folder.h"
#include "abbe/verify/error_map.h"
#include "axis_option.h"
#include "command.h"
#include "exit_code.h"
#include "messages.h"
#include "options.h"
#include "progress.h"
#include "study/job.h"
#include "study/results.h"
#include "study/summary.h"

namespace abbe {
namespace {

struct MapOptions {
  std::string machine, errors, reference, poses;
  std::vector<std::string> grid, outputs;
  bool fit_datum = false, json = false;
};

/// "X_mm=0:1400:9" or "C_deg=30": from:to:count, or a fixed position.
void apply_grid_option(const Machine& machine, const std::string& text, std::vector<AxisRange>& ranges,
                       std::vector<bool>& given) {
  const std::string expected = "AXIS_unit=from:to:count or AXIS_unit=position, such as X_mm=0:1400:9";
  const auto fail = [&](const std::string& problem) {
    throw InputError({.field = "--grid " + text}, problem, expected);
  };
  const auto [axis, unit, numbers] = axis_numbers_option(machine, "--grid", text, expected);
  if (given[axis]) fail("axis " + machine.axes[axis].name + " was given before");
  given[axis] = true;
  if (numbers.size() == 1) {
    ranges[axis] = AxisRange::fixed(numbers[0] * unit);
  } else if (numbers.size() == 3 && numbers[2] >= 2 && numbers[2] <= 1e6 && numbers[2] == std::floor(numbers[2])) {
    ranges[axis] = {numbers[0] * unit, numbers[1] * unit, static_cast<std::size_t>(numbers[2]), 0};
  } else {
    fail("one or three numbers are needed, the count a whole number from 2 to 1,000,000");
  }
}

void print_json(const Machine& machine, const ErrorMap& before, const ErrorMap* after) {
  nlohmann::ordered_json json;
  json["machine"] = machine.name;
  json["poses"] = before.statistics.count;
  json["outside_range"] = before.statistics.excluded;
  if (before.statistics.count > 0) {
    json["position_before_um"] = statistics_um(before.statistics);
    json["orientation_before_urad"] = orientation_urad(before);
    if (after != nullptr) {
      json["position_after_um"] = statistics_um(after->statistics);
      json["orientation_after_urad"] = orientation_urad(*after);
    }
    if (!before.norm_uncertainty.empty()) {
      json["standard_uncertainty_um"] = statistics_um(sample_statistics(before.norm_uncertainty, before.covered));
    }
  }
  fmt::print("{}", json_text(json));
}

void print_text(const Machine& machine, const ErrorMap& before, const ErrorMap* after) {
  fmt::print("{} poses of {}\n", before.statistics.count, machine.name);
  if (before.statistics.count == 0) return;
  const auto print = [](const char* name, const SampleStatistics& s, double unit, const char* unit_name) {
    fmt::print("{:<25} mean {:.3f}  rms {:.3f}  95 % {:.3f}  99 % {:.3f}  max {:.3f} {}\n", name, unit * s.mean,
               unit * s.rms, unit * s.p95, unit * s.p99, unit * s.maximum, unit_name);
  };
  print(after != nullptr ? "volumetric error, before" : "volumetric error", before.statistics, 1e3, "um");
  if (after != nullptr) print("volumetric error, after", after->statistics, 1e3, "um");
  if (!before.norm_uncertainty.empty()) {
    print("standard uncertainty", sample_statistics(before.norm_uncertainty, before.covered), 1e3, "um");
  }
  print(after != nullptr ? "orientation error, before" : "orientation error", orientation_statistics(before), 1e6,
        "urad");
  if (after != nullptr) print("orientation error, after", orientation_statistics(*after), 1e6, "urad");
}

int run_map(const MapOptions& options) {
  const Machine machine = read_machine(options.machine);
  const ErrorsFile errors = read_errors(options.errors, machine);
  std::optional<ErrorsFile> reference;
  if (!options.reference.empty()) reference = read_errors(options.reference, machine);

  PoseList poses;
  std::vector<std::size_t> grid;
  if (!options.poses.empty()) {
    poses = read_poses(options.poses, machine);
  } else {
    std::vector<AxisRange> ranges;
    std::vector<bool> given(machine.axes.size(), false);
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
      ranges.push_back(known_range(machine, errors.errors, i, machine.axes.size() > 3 ? 5 : 9));
    }
    for (const std::string& text : options.grid) apply_grid_option(machine, text, ranges, given);
    PoseGrid positions;
    for (const AxisRange& range : ranges) {
      grid.push_back(range.is_fixed() ? 1 : range.count);
      positions.values.push_back(evenly_spaced(range.from, range.to, grid.back()));
    }
    const PoseSource source = pose_source(positions);
    if (source.count > 20'000'000) {
      throw InputError({.field = "--grid"}, fmt::format("{} poses", source.count),
                       "at most 20,000,000 poses in a file");
    }
    poses.axis.assign(machine.axes.size(), std::vector<double>(source.count));
    std::vector<double*> pointers;
    for (std::vector<double>& values : poses.axis) pointers.push_back(values.data());
    source.fill(0, source.count, pointers.data());
  }

  Progress progress("mapping the volumetric error");
  ErrorMapOptions map_options;
  map_options.remove_rigid_motion = options.fit_datum;
  map_options.progress = progress.callback();
  ParameterCovariance covariance;
  if (errors.covariance.size() > 0) {
    covariance.covariance = errors.covariance;
    for (std::size_t p = 0; p < errors.errors.parameter_count(); ++p) covariance.parameters.push_back(p);
    map_options.covariance = &covariance;
  }
  ErrorMap before = error_map(machine, errors.errors, nullptr, pose_source(poses), map_options);
  std::optional<ErrorMap> after;
  if (reference) after = error_map(machine, errors.errors, &reference->errors, pose_source(poses), map_options);
  std::vector<ErrorMap*> maps = {&before};
  if (after) maps.push_back(&*after);
  keep_common_poses(maps);

  const MapData data = map_data(machine, poses, grid, before, after ? &*after : nullptr, &before);
  const std::string vtk = map_is_structured(data) ? ".vts" : ".vtu";
  const auto extension_of = [](const std::string& name) { return std::filesystem::path(name).extension().string(); };
  for (const std::string& output : options.outputs) {
    if (extension_of(output) == ".csv" || extension_of(output) == vtk) continue;
    throw InputError({.file = output}, "unknown kind of map file",
                     "a name ending in .csv, or in " + vtk + " for these poses");
  }
  for (const std::string& output : options.outputs) {
    write_file_atomically(output, extension_of(output) == ".csv" ? map_csv(data) : map_vtk(data));
  }
  const std::size_t outside = before.statistics.excluded;
  if (options.json) {
    print_json(machine, before, after ? &*after : nullptr);
  } else {
    print_text(machine, before, after ? &*after : nullptr);
    for (const std::string& output : options.outputs) fmt::print("{} written\n", output);
  }
  if (outside > 0) {
    tell("abbe: {} of {} poses lie outside the range in which the errors are known; they are left out\n", outside,
         poses.count());
    return kNegative;
  }
  return kDone;
}

}  // namespace

void add_map_command(CommandLine& line) {
  auto options = std::make_shared<MapOptions>();
  Subcommand* command = line.add("map", "Volumetric error over a grid or at given poses, with uncertainty",
                                 "  abbe map examples/machines/aguado.machine.toml "
                                 "examples/aguado/results/aguado/errors.toml --grid C_deg=0:315:8 -o "
                                 "map.csv -o map.vts\n"
                                 "  abbe map examples/machines/aguado.machine.toml readings/truth.errors.toml --minus "
                                 "examples/aguado/results/aguado/errors.toml "
                                 "--fit-datum\n\n"
                                 "The files are those that the examples of run and simulate write.\n"
                                 "Without --grid every axis runs over the range in which its errors are known.");
  command->add_option("machine", options->machine, "Machine file (*.machine.toml)")->required();
  command->add_option("errors", options->errors, "Errors file (*.errors.toml)")->required();
  command->add_option("--minus", options->reference,
                      "Errors corrected for (*.errors.toml): adds the error after correction");
  command->add_option("--grid", options->grid, "AXIS_unit=from:to:count or AXIS_unit=position; repeat per axis");
  command->add_option("--poses", options->poses, "CSV with one column per axis (X_mm, C_deg, ...) instead of a grid")
      ->excludes("--grid");
  command->add_flag("--fit-datum", options->fit_datum,
                    "Remove the best-fit rigid motion (choice of the workpiece datum)");
  command->add_output_file("-o,--output", options->outputs, "File to write: .csv, .vts or .vtu (ParaView); repeatable");
  command->add_flag("--json", options->json, "Print JSON for programs");
  command->callback([&line, options] { line.run = [options]() -> int { return run_map(*options); }; });
}

}  // namespace abbe
