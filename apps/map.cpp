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
#include "abbe/report/partial_errors.h"
#include "abbe/report/statistics_json.h"
#include "abbe/report/volumetric_words.h"
#include "abbe/study/results.h"
#include "abbe/study/study_result.h"
#include "abbe/study/summary.h"
#include "abbe/verify/error_map.h"
#include "abbe/verify/volumetric_figures.h"
#include "axis_option.h"
#include "command.h"
#include "errors_for_use.h"
#include "exit_code.h"
#include "options.h"
#include "progress.h"
#include "uncovered_poses.h"

namespace abbe {
namespace {

struct MapOptions {
  std::string machine, errors, reference, poses;
  std::vector<std::string> grid, outputs;
  bool fit_datum = false, keep_datum = false, accept_uncovered = false, json = false;
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

/// What a map says, in numbers.
struct MapReport {
  const Machine* machine = nullptr;
  const PartialErrors* partial = nullptr;
  const ErrorMap* before = nullptr;
  const ErrorMap* after = nullptr;           ///< null without --minus
  std::optional<VolumetricFigures> figures;  ///< with the fitted datum only: without it these are other quantities
  bool after_is_true = false;                ///< the errors are the truth of a simulation
};

void print_json(const MapReport& report) {
  const ErrorMap& before = *report.before;
  nlohmann::ordered_json json;
  json["machine"] = report.machine->name;
  json["poses"] = before.statistics.count;
  json["outside_range"] = before.statistics.excluded;
  if (before.statistics.count > 0) {
    if (report.figures) {
      add_volumetric_figures(*report.figures, json);
      if (report.after != nullptr && !report.after_is_true) {
        json["volumetric_error_minus_um"] = statistics_um(report.after->statistics);
      }
    } else {
      json["displacement_before_um"] = statistics_um(before.statistics);
      if (report.after != nullptr) json["displacement_after_um"] = statistics_um(report.after->statistics);
    }
    json["orientation_before_urad"] = orientation_urad(before);
    if (report.after != nullptr) json["orientation_after_urad"] = orientation_urad(*report.after);
    if (!before.norm_uncertainty.empty()) {
      json["standard_uncertainty_um"] = statistics_um(sample_statistics(before.norm_uncertainty, before.covered));
    }
  }
  add_partial_errors(*report.partial, json);
  fmt::print("{}", json_text(json));
}

void print_text(const MapReport& report) {
  const ErrorMap& before = *report.before;
  const PartialErrors& partial = *report.partial;
  fmt::print("{} poses of {}{}\n", before.statistics.count, report.machine->name,
             partial.is_partial() ? "; known are " + partial.short_words() + " that it can have" : "");
  if (before.statistics.count == 0) return;
  const auto print = [](const char* name, const SampleStatistics& s) {
    fmt::print("  {:<46} mean {:>9.3f}   95 % {:>9.3f}   max {:>9.3f} urad\n", name, 1e6 * s.mean, 1e6 * s.p95,
               1e6 * s.maximum);
  };
  const bool two = report.after != nullptr;
  if (report.figures) {
    fmt::print("{}", volumetric_text(*report.figures));
    if (two && !report.after_is_true) {
      fmt::print("{}", error_line("difference from the errors of --minus", report.after->statistics));
    }
  } else {
    fmt::print("displacement of the functional point, the workpiece datum as it is\n");
    fmt::print("{}", error_line(two ? "before" : "as it is", before.statistics));
    if (two) fmt::print("{}", error_line("after", report.after->statistics));
  }
  if (!before.norm_uncertainty.empty()) {
    fmt::print("{}", error_line("standard uncertainty along the displacement",
                                sample_statistics(before.norm_uncertainty, before.covered)));
  }
  print(two ? "orientation error, before" : "orientation error", orientation_statistics(before));
  if (two) print("orientation error, after", orientation_statistics(*report.after));
  if (partial.is_partial()) fmt::print("caution: {}\n", partial.caution());
}

int run_map(const MapOptions& options) {
  const Machine machine = read_machine(options.machine);
  const ErrorsFile errors = read_errors_and_tell(options.errors, machine);
  std::optional<ErrorsFile> reference;
  if (!options.reference.empty()) reference = read_errors_and_tell(options.reference, machine);

  StatedPoses stated;
  if (!options.poses.empty()) {
    stated.poses = read_poses(options.poses, machine);
    stated.words =
        fmt::format("{} poses of {}", stated.poses.count(), std::filesystem::path(options.poses).filename().string());
  } else {
    std::vector<const ErrorSet*> known = {&errors.errors};
    if (reference) known.push_back(&reference->errors);
    std::vector<AxisRange> ranges = stated_ranges(machine, known);
    std::vector<bool> given(machine.axes.size(), false);
    for (const std::string& text : options.grid) apply_grid_option(machine, text, ranges, given);
    double count = 1;
    for (const AxisRange& range : ranges) count *= static_cast<double>(range.is_fixed() ? 1 : range.count);
    if (count > 20e6) {
      throw InputError({.field = "--grid"}, fmt::format("{:.0f} poses", count), "at most 20,000,000 poses in a file");
    }
    stated = grid_over(machine, ranges);
  }
  const PoseList& poses = stated.poses;

  Progress progress("mapping the volumetric error");
  ErrorMapOptions map_options;
  map_options.remove_rigid_motion = !options.keep_datum;
  map_options.progress = progress.callback();
  const auto with_covariance = [&](const ErrorsFile& file, ParameterCovariance& covariance) {
    ErrorMapOptions with = map_options;
    covariance.covariance = covariance_of(file);
    for (std::size_t p = 0; p < file.errors.parameter_count(); ++p) covariance.parameters.push_back(p);
    if (covariance.covariance.size() > 0) with.covariance = &covariance;
    return with;
  };
  ParameterCovariance covariance, covariance_of_reference;
  ErrorMap before = error_map(machine, errors.errors, nullptr, pose_source(poses), with_covariance(errors, covariance));
  std::optional<ErrorMap> after, predicted;
  MapReport report;
  report.machine = &machine;
  report.before = &before;
  if (reference) {
    after = error_map(machine, errors.errors, &reference->errors, pose_source(poses), map_options);
    report.after = &*after;
  }
  std::vector<ErrorMap*> maps = {&before};
  if (after) maps.push_back(&*after);
  keep_common_poses(maps);
  if (!options.keep_datum && is_truth(errors)) {
    report.after_is_true = true;
    if (reference) {
      predicted = error_map(machine, reference->errors, nullptr, pose_source(poses),
                            with_covariance(*reference, covariance_of_reference));
    }
    report.figures =
        figures_of_maps(stated.words, predicted ? &*predicted : nullptr, &before, after ? &*after : nullptr);
  } else if (!options.keep_datum) {
    report.figures = figures_of_maps(stated.words, &before, nullptr, nullptr);
  }

  const MapData data = map_data(machine, poses, stated.grid, before, after ? &*after : nullptr, &before);
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
  const PartialErrors partial = partial_errors(machine, errors);
  report.partial = &partial;
  if (options.json) {
    print_json(report);
  } else {
    print_text(report);
    for (const std::string& output : options.outputs) fmt::print("{} written\n", output);
  }
  return tell_left_out({.all = poses.count(), .not_covered = before.statistics.excluded}, options.accept_uncovered);
}

}  // namespace

void add_map_command(CommandLine& line) {
  auto options = std::make_shared<MapOptions>();
  Subcommand* command = line.add("map", "Compute the volumetric error over a grid or at given poses, with uncertainty",
                                 "  abbe map examples/machines/aguado.machine.toml "
                                 "examples/aguado/results/aguado/errors.toml --grid C_deg=0:315:8 -o "
                                 "map.csv -o map.vts\n"
                                 "  abbe map examples/machines/aguado.machine.toml readings/truth.errors.toml --minus "
                                 "examples/aguado/results/aguado/errors.toml\n\n"
                                 "The examples of run and simulate write these files. docs/conventions.md defines the\n"
                                 "figures. Without --grid, every axis runs over the range in which its errors are\n"
                                 "known.");
  command->add_option("machine", options->machine, "Machine file (*.machine.toml)")->required();
  command->add_option("errors", options->errors, "Errors file (*.errors.toml)")->required();
  command->add_option("--minus", options->reference,
                      "Errors that are corrected (*.errors.toml): adds the error that remains");
  command->add_option("--grid", options->grid, "AXIS_unit=from:to:count or AXIS_unit=position; repeat per axis");
  command->add_option("--poses", options->poses, "CSV with one column per axis (X_mm, C_deg, ...) instead of a grid")
      ->excludes("--grid");
  command->add_flag("--keep-datum", options->keep_datum,
                    "Keep the workpiece datum where it is: gives displacements, not the volumetric error");
  command
      ->add_flag("--fit-datum", options->fit_datum,
                 "Remove the best-fit rigid motion of the workpiece (done unless --keep-datum is given)")
      ->excludes("--keep-datum");
  command->add_flag("--accept-uncovered", options->accept_uncovered, kAcceptUncoveredWords);
  command->add_output_file("-o,--output", options->outputs, "File to write: .csv, .vts or .vtu (ParaView); repeatable");
  command->add_flag("--json", options->json, "Print JSON for programs");
  command->callback([&line, options] { line.run = [options]() -> int { return run_map(*options); }; });
}

}  // namespace abbe
