#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "abbe/compensate/point_correction.h"
#include "abbe/compensate/tables/plane_corrections.h"
#include "abbe/controls/lattice_writer.h"
#include "abbe/controls/line_writer.h"
#include "abbe/controls/lost_motion.h"
#include "abbe/controls/table_format.h"
#include "abbe/formats/controls/table_aerotech.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {
namespace {

/// mm: a table that nowhere says more is not written.
constexpr double kNoCorrection = 1e-6;
/// A row of three corrections each then has fewer characters than the 10000 that a control reads at once.
constexpr std::size_t kPlaneColumns = 250;
constexpr std::size_t kPlaneNodes = kPlaneColumns * kPlaneColumns;

const char* const kUnits =
    "positions and corrections are in primary units: CountsPerUnit of every axis has to be counts per mm (rotary: per "
    "degree), and above zero; zero of the machine file is position zero of the control, after homing";

WrittenTables make_aerotech_lines(const TableFormat& format, const Machine& machine, const ErrorSet& errors,
                                  const WriterRequest& request) {
  WrittenTables made;
  const std::vector<AxisTable> tables = wanted_tables(machine, errors, request, line_options(request, format), made);
  std::vector<AxisTable> read;
  if (!tables.empty()) {
    const std::string name = "AXES-1D.cal";
    const std::string text = aerotech_1d_text(with_sign(tables, request.negate), request.names);
    read = with_sign(parse_aerotech_1d(text, name, request.names), request.negate);
    // A rotary axis that rolls over is between 0 and 360 degrees; the file does not say it.
    for (AxisTable& table : read) table.modulo = machine.axes[table.input].endless;
    made.files.push_back({name, text});
    made.remarks = {kUnits,
                    "load the file as the 1-D axis calibration (A3200: LOADCALFILE, CALENABLE; Automation1: "
                    "Configure, Calibration)"};
  }
  made.correction = std::make_unique<AxisTableCorrection>(std::move(read));
  return made;
}

/// All tables together: which axes they are over, which they correct, and the limits of each one alone.
LatticeOptions plane_options(const Machine& machine, const ErrorSet& errors, const WriterRequest& request,
                             const TableFormat& format) {
  LatticeOptions options = lattice_options(machine, errors, request, format, 3, true);
  const std::string expected = "two or three linear axes that move";
  for (const std::size_t axis : options.inputs) {
    if (machine.axes[axis].kind == AxisKind::linear) continue;
    throw InputError({.field = "--axis " + machine.axes[axis].name}, "is a rotary axis", expected);
  }
  if (options.inputs.size() < 2) {
    throw InputError({.field = "--axis"}, "one axis for tables over two axes", expected);
  }
  if (options.outputs.size() > 3) {
    throw InputError({.field = "--for"}, fmt::format("the machine has {} linear axes", options.outputs.size()),
                     "at most three: a table corrects no more");
  }
  options.tolerance_mm /= static_cast<double>(axis_pairs(options.inputs).size());
  options.most_per_axis = kPlaneColumns;
  return options;
}

std::string plane_name(const Machine& machine, const std::array<std::size_t, 2>& pair, std::size_t output) {
  return fmt::format("{}, {} for {}", machine.axes[pair[0]].name, machine.axes[pair[1]].name,
                     machine.axes[output].name);
}

/// The first two axes of a table correct something, or are there because it has to have two; others only if they do.
void drop_third_output(CorrectionLattice& lattice) {
  for (std::size_t o = lattice.outputs.size(); o-- > 0 && lattice.outputs.size() > 2;) {
    const std::vector<double>& values = lattice.corrections[o];
    if (std::any_of(values.begin(), values.end(), [](double value) { return value != 0; })) continue;
    lattice.outputs.erase(lattice.outputs.begin() + static_cast<std::ptrdiff_t>(o));
    lattice.corrections.erase(lattice.corrections.begin() + static_cast<std::ptrdiff_t>(o));
  }
}

std::vector<CorrectionLattice> with_plane_sign(std::vector<CorrectionLattice> lattices, bool negate) {
  for (CorrectionLattice& lattice : lattices) {
    for (std::vector<double>& values : lattice.corrections) {
      for (double& value : values) value = negate ? 0.0 - value : value;
    }
  }
  return lattices;
}

/// One table over two axes, built, with what is said of it; corrections that are left out or nothing are zero.
CorrectionLattice make_plane(const Machine& machine, const ErrorSet& errors, const WriterRequest& request,
                             const LatticeOptions& options, std::size_t index, WrittenTables& made) {
  const std::array<std::size_t, 2> pair = axis_pairs(options.inputs)[index];
  const PlaneCorrection function(machine, errors, options, index);
  LatticeOptions own = options;
  own.inputs = {pair[0], pair[1]};
  BuiltLattice built = lattice_over(machine, errors, own, lattice_nodes(machine, errors, own, function), function);
  CorrectionLattice& lattice = built.lattice;
  for (std::size_t o = 0; o < lattice.outputs.size(); ++o) {
    std::vector<double>& values = lattice.corrections[o];
    const std::string name = plane_name(machine, pair, lattice.outputs[o]);
    const bool nothing =
        std::all_of(values.begin(), values.end(), [](double value) { return std::abs(value) <= kNoCorrection; });
    if (nothing || request.left_out.count(name) != 0) {
      values.assign(values.size(), 0.0);
      continue;
    }
    made.tables.push_back(
        lattice_summary(machine, built, own, o, name, [&machine, options, index](const ErrorSet& other) {
          return std::make_unique<PlaneCorrection>(machine, other, options, index);
        }));
  }
  drop_third_output(lattice);
  return std::move(lattice);
}

WrittenTables make_aerotech_planes(const TableFormat& format, const Machine& machine, const ErrorSet& errors,
                                   const WriterRequest& request) {
  WrittenTables made;
  const LatticeOptions options = plane_options(machine, errors, request, format);
  const std::vector<std::array<std::size_t, 2>> pairs = axis_pairs(options.inputs);
  std::vector<std::unique_ptr<CommandCorrection>> parts;
  std::vector<CorrectionLattice> lattices;
  for (std::size_t index = 0; index < pairs.size(); ++index) {
    if (request.nodes > 0) {
      LatticeOptions wanted = options;
      std::erase_if(wanted.outputs, [&](std::size_t output) {
        return request.left_out.count(plane_name(machine, pairs[index], output)) != 0;
      });
      parts.push_back(std::make_unique<PlaneCorrection>(machine, errors, wanted, index));
      continue;
    }
    const std::size_t before = made.tables.size();
    CorrectionLattice lattice = make_plane(machine, errors, request, options, index, made);
    if (made.tables.size() > before) lattices.push_back(std::move(lattice));
  }
  if (!lattices.empty()) {
    const std::string name = "AXES-2D.cal";
    const std::string text = aerotech_2d_text(with_plane_sign(lattices, request.negate), request.names);
    made.files.push_back({name, text});
    made.remarks = {kUnits,
                    "load the file as the 2-D axis calibration (A3200: LOADCALFILE \"...\", 2D_CAL and CALENABLE 2D; "
                    "Automation1: Configure, Calibration)"};
    for (CorrectionLattice& read : with_plane_sign(parse_aerotech_2d(text, name, request.names), request.negate)) {
      made.remarks.push_back(fmt::format("table of {} {} x {} {}; other axes as --at says", read.positions[0].size(),
                                         machine.axes[read.inputs[0]].name, read.positions[1].size(),
                                         machine.axes[read.inputs[1]].name));
      parts.push_back(std::make_unique<LatticeCorrection>(std::move(read)));
    }
  }
  made.correction = std::make_unique<CorrectionSum>(std::move(parts));
  return made;
}

TableFormat aerotech_format() {
  using enum TableSetting;
  TableFormat format;
  format.control = "Aerotech A3200, Automation1";
  format.takes = {negate, reference, names, axes, tolerance_mm, most_nodes};
  format.backlash = [](const std::string& axis, double lost_motion, bool rotary) {
    return fmt::format("parameter BacklashDistance of axis {} compensates it (sign not verified): {}", axis,
                       lost_motion_words(lost_motion, rotary));
  };
  format.axis_names = "number of the axis in calibration files, counted from 1";
  format.default_name = [](std::size_t index, const Axis& /*axis*/) { return fmt::format("{}", index + 1); };
  format.unverified =
      "the sign of the corrections (--negate): programs that others publish write nominal minus measured, as here, for "
      "axes with CountsPerUnit above zero; with CountsPerUnit below zero, distances, offsets and corrections change "
      "their sign; such files are not written";
  return format;
}

}  // namespace

TableFormat aerotech_1d_format() {
  TableFormat format = aerotech_format();
  format.name = "aerotech-1d";
  format.kind = TableKind::axis_pairs;
  format.what = "1-D axis calibration of Aerotech (:START): each axis corrects itself and the linear axes";
  format.convention =
      "values are corrections (minus the error), mm or degrees, of the axis behind :START at the position of the axis "
      "MASTER; the first at -OFFSET, the others every SAMPLEDIST. Straight lines between them, the end values outside";
  format.unverified +=
      "; that positions of a rotary MASTER are in degrees; that tables of axes that roll over are looked up from 0 to "
      "360 degrees";
  format.takes.insert(TableSetting::tolerance_rad);
  format.cannot =
      "each table depends on the position of one axis, and tables add up: an angle times a lever that another axis "
      "changes is corrected only on the lines through the reference pose (see aerotech-2d), and the direction of the "
      "tool is not corrected";
  format.write = [format](const Machine& machine, const ErrorSet& errors, const WriterRequest& request) {
    return make_aerotech_lines(format, machine, errors, request);
  };
  return format;
}

TableFormat aerotech_2d_format() {
  TableFormat format = aerotech_format();
  format.name = "aerotech-2d";
  format.kind = TableKind::lattice;
  format.what = "2-D axis calibration of Aerotech (:START2D), a table per two of two or three linear axes";
  format.convention =
      "values are corrections (minus the error), mm, of the output axes at positions of a row and a column axis; the "
      "first at -OFFSETROW and -OFFSETCOL. Linear in every position between them, the end values outside; tables add "
      "up";
  format.unverified += "; that interpolation in a cell is linear in each position (bilinear)";
  format.most_nodes = kPlaneNodes;
  format.cannot =
      "linear axes correct the shift of the point with the rotary axes where --at puts them; effects of three axes "
      "together are corrected only on the planes through the reference pose; rotary axes and the direction of the tool "
      "are not corrected";
  format.write = [format](const Machine& machine, const ErrorSet& errors, const WriterRequest& request) {
    return make_aerotech_planes(format, machine, errors, request);
  };
  return format;
}

}  // namespace abbe
