#include "wang/grids.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <system_error>

#include "abbe/formats/files/results_folder.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/formats/readings/indication_file.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/json_text.h"
#include "abbe/identify/distributions.h"
#include "abbe/identify/linkage/decoupled_errors.h"
#include "abbe/machine/axis_unit.h"
#include "exit_code.h"
#include "wang/dials.h"
#include "wang/study.h"

namespace abbe {
namespace {

struct GridFile {
  std::filesystem::path path;
  IndicationTable table;
  Decoupling found;
};

std::vector<std::filesystem::path> csv_files(const std::filesystem::path& folder) {
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) {
    throw InputError({.file = folder.string()}, "there is no such folder", "a folder with files X.csv, A.csv, ...");
  }
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".csv") files.push_back(entry.path());
  }
  if (files.empty()) throw InputError({.file = folder.string()}, "no file ends in .csv", "readings of one axis a file");
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<GridFile> read_all(const std::filesystem::path& folder, const Machine& machine) {
  const IndicationOptions defaults{.along_axis = kWangLaserUncertainty, .across_axis = kWangDialUncertainty};
  std::vector<GridFile> files;
  for (const std::filesystem::path& path : csv_files(folder)) {
    GridFile file{path, read_indications(path, machine, defaults), {}};
    for (const GridFile& other : files) {
      if (other.table.axis != file.table.axis) continue;
      throw InputError({.file = path.string()},
                       fmt::format("axis {} was read from {}", machine.axes[file.table.axis].name, other.path.string()),
                       "one file per axis");
    }
    file.found = decouple_indications(file.table.readings);
    files.push_back(std::move(file));
  }
  return files;
}

/// Position, error motions and their uncertainties.
std::string decoupling_csv(const Machine& machine, const GridFile& file) {
  const Axis& axis = machine.axes[file.table.axis];
  std::string text = axis.name + "_" + position_suffix(axis);
  for (std::size_t c = 0; c < 6; ++c) {
    if (!file.found.seen[c]) continue;
    const auto component = static_cast<Component>(c);
    const std::string name =
        error_motion_name(machine, file.table.axis, component) + "_" + micro_unit(is_rotation(component));
    text += fmt::format(",{},u_{}", name, name);
  }
  text += '\n';
  for (std::size_t i = 0; i < file.found.positions.size(); ++i) {
    text += fmt::format("{:.9g}", file.found.positions[i] / position_unit(axis));
    for (std::size_t c = 0; c < 6; ++c) {
      if (!file.found.seen[c]) continue;
      const auto component = static_cast<Component>(c);
      const double micro = micro_per_unit(is_rotation(component));
      text += fmt::format(",{:.6f},{:.6f}",
                          file.found.errors(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(c)) * micro,
                          file.found.standard_uncertainty(component, i) * micro);
    }
    text += '\n';
  }
  return text;
}

void print(const Machine& machine, const GridFile& file) {
  const Decoupling& found = file.found;
  const Axis& axis = machine.axes[file.table.axis];
  const bool linear = axis.kind == AxisKind::linear;
  fmt::print("{}: axis {}, {} positions, {} probes\n", file.path.string(), axis.name, found.positions.size(),
             file.table.readings.probes.size());
  if (found.status != DecouplingStatus::ok) {
    fmt::print("  not decoupled: {}\n\n", found.message);
    return;
  }
  fmt::print("  {:>10}", fmt::format("{} / {}", axis.name, position_suffix(axis)));
  for (std::size_t c = 0; c < 6; ++c) {
    if (!found.seen[c]) continue;
    const auto component = static_cast<Component>(c);
    const std::string name = error_motion_name(machine, file.table.axis, component);
    fmt::print(" {:>12} {:>8}", fmt::format("{} / {}", name, micro_unit(is_rotation(component))), "u");
  }
  fmt::print("\n");
  for (std::size_t i = 0; i < found.positions.size(); ++i) {
    fmt::print("  {:>10.3f}", found.positions[i] / position_unit(axis));
    for (std::size_t c = 0; c < 6; ++c) {
      if (!found.seen[c]) continue;
      const auto component = static_cast<Component>(c);
      const double micro = micro_per_unit(is_rotation(component));
      fmt::print(" {:>12.3f} {:>8.3f}",
                 found.errors(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(c)) * micro,
                 found.standard_uncertainty(component, i) * micro);
    }
    fmt::print("\n");
  }
  for (std::size_t c = 0; linear && c < 3; ++c) {
    if (found.removed[c].empty()) continue;
    fmt::print("  removed from {}: {:.3f} um at {} = 0 and {:.3f} urad of slope (dial zero, setting of the face)\n",
               error_motion_name(machine, file.table.axis, static_cast<Component>(c)), 1e3 * found.removed[c][0],
               axis.name, 1e6 * found.removed[c][1]);
  }
  if (linear) fmt::print("  angles as indicated: their constants are those of the faces and of the dials' zeros\n");
  for (const std::string& note : found.notes) fmt::print("  {}\n", note);
  if (found.degrees_of_freedom > 0) {
    fmt::print("  misfit: chi-square {:.1f} with {} degrees of freedom, probability {:.3f}\n", found.chi_square,
               found.degrees_of_freedom,
               chi_square_exceedance(found.chi_square, static_cast<double>(found.degrees_of_freedom)));
  }
  fmt::print("\n");
}

nlohmann::ordered_json json_of(const Machine& machine, const GridFile& file) {
  nlohmann::ordered_json json;
  json["file"] = file.path.string();
  json["axis"] = machine.axes[file.table.axis].name;
  json["decoupled"] = file.found.status == DecouplingStatus::ok;
  if (file.found.status != DecouplingStatus::ok) {
    json["reason"] = file.found.message;
    return json;
  }
  for (std::size_t c = 0; c < 6; ++c) {
    if (!file.found.seen[c]) continue;
    const auto component = static_cast<Component>(c);
    const bool angle = is_rotation(component);
    const double micro = micro_per_unit(angle);
    std::vector<double> values, uncertainties;
    for (std::size_t i = 0; i < file.found.positions.size(); ++i) {
      values.push_back(file.found.errors(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(c)) * micro);
      uncertainties.push_back(file.found.standard_uncertainty(component, i) * micro);
    }
    const std::string name = error_motion_name(machine, file.table.axis, component) + "_" + micro_unit(angle);
    json[name] = values;
    json["u_" + name] = uncertainties;
  }
  json["notes"] = file.found.notes;
  json["chi_square"] = file.found.chi_square;
  json["degrees_of_freedom"] = file.found.degrees_of_freedom;
  return json;
}

void write(const std::filesystem::path& output, Machine machine, const std::vector<GridFile>& files) {
  std::vector<DecoupledAxis> axes;
  for (const GridFile& file : files) {
    if (file.found.status != DecouplingStatus::ok) continue;
    axes.push_back({file.table.axis, file.found});
    // A map of the written machine must not go beyond what was measured.
    Axis& axis = machine.axes[file.table.axis];
    axis.travel_min = file.found.positions.front();
    axis.travel_max = file.found.positions.back();
  }
  const DecoupledErrors errors = decoupled_errors(axes);
  const ErrorsFile contents{errors.errors, errors.covariance, {{"method", "decoupling of dial and laser indications"}}};
  ResultsFolder folder(output);
  folder.write("machine.machine.toml", machine_text(machine));
  folder.write("decoupled.errors.toml", errors_text(machine, contents, "decoupled.covariance.csv"));
  folder.write("decoupled.covariance.csv", covariance_text(machine, contents));
  for (const GridFile& file : files) {
    if (file.found.status != DecouplingStatus::ok) continue;
    folder.write(fmt::format("decoupled_{}.csv", machine.axes[file.table.axis].name), decoupling_csv(machine, file));
  }
  folder.commit();
}

}  // namespace

int decouple_wang_grids(const ReproduceOptions& options) {
  const Machine machine = wang_machine();
  const std::vector<GridFile> files = read_all(options.grids, machine);
  const auto is_ok = [](const GridFile& file) { return file.found.status == DecouplingStatus::ok; };
  const bool any = std::any_of(files.begin(), files.end(), is_ok);
  if (!options.output.empty() && any) write(options.output, machine, files);
  if (options.json) {
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const GridFile& file : files) json.push_back(json_of(machine, file));
    fmt::print("{}", json_text(json));
  } else {
    fmt::print("Grinder {}; probes without u_um: dials u = {:.3g} um, along the axis u = {:.3g} um\n\n",
               machine.chain(), 1e3 * kWangDialUncertainty, 1e3 * kWangLaserUncertainty);
    for (const GridFile& file : files) print(machine, file);
    if (!options.output.empty() && any) fmt::print("results in {}\n", options.output);
  }
  return std::all_of(files.begin(), files.end(), is_ok) ? kDone : kNegative;
}

}  // namespace abbe
