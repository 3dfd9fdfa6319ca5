#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "abbe/compensate/tables/anchored_lattice.h"
#include "abbe/compensate/tables/whole_unit_correction.h"
#include "abbe/controls/lattice_writer.h"
#include "abbe/controls/lost_motion.h"
#include "abbe/controls/table_format.h"
#include "abbe/formats/controls/table_fanuc_lattice.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

constexpr std::size_t kLatticeAxes = 3;

LatticeOptions three_linear_axes(const Machine& machine, const ErrorSet& errors, const WriterRequest& request,
                                 const TableFormat& format) {
  LatticeOptions options = lattice_options(machine, errors, request, format, kLatticeAxes, true);
  const bool linear = std::all_of(options.inputs.begin(), options.inputs.end(),
                                  [&](std::size_t axis) { return machine.axes[axis].kind == AxisKind::linear; });
  if (options.inputs.size() != kLatticeAxes || !linear) {
    throw InputError({.field = "--axis"}, fmt::format("{} axes for the grid", options.inputs.size()),
                     "three linear axes that move");
  }
  std::erase_if(options.outputs, [&](std::size_t axis) {
    return std::find(options.inputs.begin(), options.inputs.end(), axis) == options.inputs.end();
  });
  options.most_per_axis = kFanucLatticePoints;
  return options;
}

/// A lattice and what it is in whole numbers.
struct Rounded {
  AnchoredLattice made;
  FanucLattice fanuc;
  int magnification = 1;  ///< largest of the axes
};

Rounded rounded_lattice(const Machine& machine, const ErrorSet& errors, const AnchoredLatticeOptions& options,
                        double unit) {
  Rounded rounded{build_anchored_lattice(machine, errors, options), {}, 1};
  std::array<std::size_t, kLatticeAxes> anchor{};
  for (std::size_t a = 0; a < kLatticeAxes; ++a) anchor[a] = rounded.made.nodes[a].anchor;
  rounded.fanuc = fanuc_lattice(rounded.made.lattice, unit, anchor);
  rounded.magnification = *std::max_element(rounded.fanuc.magnification.begin(), rounded.fanuc.magnification.end());
  return rounded;
}

/// What a magnification leaves of the tolerance for the interpolation.
///
/// Linear interpolation between values that are each off by at most half a step is off by no more than that.
double tolerance_left(double tolerance, double unit, int magnification) {
  return tolerance - 0.5 * unit * magnification;
}

WrittenTables make_fanuc_lattice(const TableFormat& format, const Machine& machine, const ErrorSet& errors,
                                 const WriterRequest& request) {
  WrittenTables made;
  const LatticeOptions options = three_linear_axes(machine, errors, request, format);
  if (request.nodes > 0) {
    made.correction = std::make_unique<LatticeFunction>(machine, errors, options);
    return made;
  }
  const double unit = request.unit_mm;
  std::array<double, kLatticeAxes> reference{};
  AnchoredLatticeOptions anchored;
  anchored.lattice = options;
  for (std::size_t a = 0; a < kLatticeAxes; ++a) {
    reference[a] = request.reference_position[options.inputs[a]];
    anchored.anchor.push_back(reference[a]);
  }
  // How far the corrections reach decides on the magnification, and that on what rounding leaves to the interpolation.
  int magnification = 1;
  double left = tolerance_left(request.tolerance_mm, unit, magnification);
  anchored.lattice.tolerance_mm = left > 0 ? left : request.tolerance_mm;
  Rounded rounded = rounded_lattice(machine, errors, anchored, unit);
  while (left > 0 && rounded.magnification > magnification) {
    magnification = rounded.magnification;
    left = tolerance_left(request.tolerance_mm, unit, magnification);
    anchored.lattice.tolerance_mm = left > 0 ? left : request.tolerance_mm;
    rounded = rounded_lattice(machine, errors, anchored, unit);
  }
  BuiltLattice& built = rounded.made.built;
  const CorrectionLattice found = fanuc_lattice_corrections(rounded.fanuc, unit, reference);
  std::vector<double> largest;
  for (std::size_t o = 0; o < options.outputs.size(); ++o) {
    const auto a = static_cast<std::size_t>(
        std::find(options.inputs.begin(), options.inputs.end(), options.outputs[o]) - options.inputs.begin());
    double rounding = 0, most = 0;
    for (std::size_t k = 0; k < found.count(); ++k) {
      rounding = std::max(rounding, std::abs(found.corrections[a][k] - rounded.made.lattice.corrections[o][k]));
      most = std::max(most, std::abs(found.corrections[a][k]));
    }
    built.interpolation_error[o] += rounding;
    largest.push_back(most);
  }
  add_lattice_summaries(machine, built, options, made);
  const double step_um = 1e3 * unit * rounded.magnification;
  for (std::size_t o = 0; o < made.tables.size(); ++o) {
    // Points outside the travel are in the file too.
    made.tables[o].nodes = found.count();
    made.tables[o].largest = std::max(made.tables[o].largest, largest[o]);
  }
  if (left <= 0) {
    made.problems.push_back(
        fmt::format("values in steps of {:g} um (detection unit of {:g} um, magnification {}) are rounded by up to "
                    "{:g} um, which leaves nothing of --interpolation-um {:g}",
                    step_um, 1e3 * unit, rounded.magnification, 0.5 * step_um, 1e3 * request.tolerance_mm));
  }
  if (rounded.magnification > kFanucLatticeMagnification) {
    made.problems.push_back(
        fmt::format("corrections are too large for {} times a detection unit of {:g} um, with a "
                    "magnification of at most {}",
                    kFanucLatticeLargest, 1e3 * unit, kFanucLatticeMagnification));
  }
  if (found.count() > options.most_nodes) {
    made.problems.push_back(
        fmt::format("a grid through the reference position has at least {} points, --max-points "
                    "says {}",
                    found.count(), options.most_nodes));
  }
  if (!made.problems.empty()) {
    made.correction = std::make_unique<LatticeCorrection>(found);
    return made;
  }
  std::string grid, ties;
  for (std::size_t a = 0; a < kLatticeAxes; ++a) {
    const FanucLattice& fanuc = rounded.fanuc;
    const std::string& name = machine.axes[fanuc.axes[a]].name;
    grid += fmt::format("{}{} {} every {:g} mm", a == 0 ? "" : " x ", fanuc.points[a], name, fanuc.interval[a]);
    ties += fmt::format("{}{} point {} at {:g} mm", a == 0 ? "" : ", ", name, fanuc.reference_point[a], reference[a]);
  }
  // Instead of the grid inside the travel.
  made.remarks = {
      fmt::format("grid of {}, {} points; rotary axes as --at says", grid, found.count()),
      "points are counted from the reference positions of the control (its parameter 1240): " + ties +
          " of the machine file; --reference-position says where else they are",
      fmt::format(
          "data are in steps of {:g} um at most, whose rounding is in \"between nodes\"; what the control adds is "
          "taken in whole detection units of {:g} um",
          step_um, 1e3 * unit),
      "compare both files with what your control punches of its own three-dimensional error compensation "
      "before loading them: their form is an assumption"};
  const auto with_sign = [&](FanucLattice lattice) {
    for (std::vector<int>& values : lattice.values) {
      for (int& value : values) value = request.negate ? -value : value;
    }
    return lattice;
  };
  const FanucLattice written = with_sign(rounded.fanuc);
  const std::string parameter_name = "3D-GRID.PRM", point_name = "3D-POINTS.PRM";
  const std::string parameters = fanuc_lattice_parameter_text(written, request.names);
  const std::string points = fanuc_lattice_point_text(written, request.names);
  made.files = {{parameter_name, parameters}, {point_name, points}};
  const FanucLattice read =
      with_sign(parse_fanuc_lattice(parameters, parameter_name, points, point_name, request.names));
  made.correction = std::make_unique<WholeUnitCorrection>(
      std::make_unique<LatticeCorrection>(fanuc_lattice_corrections(read, unit, reference)), unit);
  return made;
}

}  // namespace

TableFormat fanuc_lattice_format() {
  using enum TableSetting;
  TableFormat format;
  format.name = "fanuc-3d";
  format.control = "FANUC";
  format.kind = TableKind::lattice;
  format.what = "three-dimensional error compensation of FANUC, three linear axes over a grid of their positions";
  format.convention =
      "corrections (minus the error) of every axis at numbered points, in whole detection units times the "
      "magnification, to be added to the commands; linear in every position between the points, the end values outside";
  format.unverified =
      "the record form of the points, which is not public (blocks as in a parameter file, N point, A axis, P value, "
      "are an assumption: compare with an output (punch) of your own control before loading); the numbers of the "
      "parameters (10800 to 10814), the order of the points (first axis fastest, from 1), their largest number (25 "
      "per axis, 15625), the range of values (-128 to 127) and magnification (100), the sign (--negate), that "
      "values are whole corrections and not steps, and what holds outside the grid";
  format.takes = {negate, detection_unit, reference_position, reference, names, axes, tolerance_mm, most_nodes};
  format.backlash = [](const std::string& axis, double lost_motion, bool rotary) {
    return fmt::format("parameter 1851 of axis {} compensates it, in detection units (sign not verified): {}", axis,
                       lost_motion_words(lost_motion, rotary));
  };
  format.axis_names = "number of the controlled axis";
  format.default_tolerance_mm = 1e-3;
  format.most_nodes = kFanucLatticePoints * kFanucLatticePoints * kFanucLatticePoints;
  format.cannot =
      "linear axes correct the shift of the point with the rotary axes where --at puts them; whole units are added; "
      "rotary axes and the direction of the tool are not corrected";
  format.default_name = [](std::size_t index, const Axis& /*axis*/) { return fmt::format("{}", index + 1); };
  format.write = [format](const Machine& machine, const ErrorSet& errors, const WriterRequest& request) {
    return make_fanuc_lattice(format, machine, errors, request);
  };
  return format;
}

}  // namespace abbe
