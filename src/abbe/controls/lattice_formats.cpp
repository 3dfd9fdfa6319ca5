#include "abbe/compensate/point_correction.h"
#include "abbe/compensate/tables/correction_lattice.h"
#include "abbe/controls/lattice_writer.h"
#include "abbe/controls/table_format.h"
#include "abbe/formats/controls/table_lattice.h"

namespace abbe {
namespace {

WrittenTables make_lattice(bool vtk, const TableFormat& format, const Machine& machine, const ErrorSet& errors,
                           const WriterRequest& request) {
  WrittenTables made;
  const std::size_t most_inputs = vtk ? 3 : kMaxAxes;
  const LatticeOptions options =
      lattice_options(machine, errors, request, format, most_inputs, most_inputs < machine.axes.size());
  if (request.nodes > 0) {
    made.correction = std::make_unique<LatticeFunction>(machine, errors, options);
    return made;
  }
  const BuiltLattice built = build_lattice(machine, errors, options);
  add_lattice_summaries(machine, built, options, made);
  const std::string name = vtk ? "lattice.vtk" : "lattice.csv";
  const std::string text =
      vtk ? lattice_vtk_text(built.lattice, request.names) : lattice_csv_text(built.lattice, request.names);
  CorrectionLattice read =
      vtk ? parse_lattice_vtk(text, name, request.names) : parse_lattice_csv(text, name, request.names);
  // Who uses the lattice has to know which axes turn endlessly; the file does not say it.
  for (std::size_t a = 0; a < read.inputs.size(); ++a) {
    read.modulo[a] = known_travel(machine, errors, read.inputs[a]).whole_turn;
  }
  made.files.push_back({name, text});
  made.correction = std::make_unique<LatticeCorrection>(std::move(read));
  return made;
}

}  // namespace

TableFormat lattice_csv_format() {
  using enum TableSetting;
  TableFormat format;
  format.name = "lattice-csv";
  format.control = "any";
  format.kind = TableKind::lattice;
  format.what = "corrections of all axes over a grid of axis positions, CSV";
  format.convention =
      "columns of axis positions (X_mm, C_deg), then the corrections (minus the error) to be added to the commands "
      "(um, "
      "urad); linear in every position between the nodes, the end values outside";
  format.takes = {reference, names, axes, tolerance_mm, tolerance_rad, most_nodes};
  format.most_nodes = 2'000'000;
  format.cannot =
      "linear axes correct the shift of the point, rotary axes their own positioning error; the direction of the tool "
      "is not corrected";
  format.write = [format](const Machine& machine, const ErrorSet& errors, const WriterRequest& request) {
    return make_lattice(false, format, machine, errors, request);
  };
  return format;
}

TableFormat lattice_vtk_format() {
  TableFormat format = lattice_csv_format();
  format.name = "lattice-vtk";
  format.what = "the same over one to three axes for ParaView, legacy VTK; the linear ones without --axis";
  format.convention =
      "coordinates are axis positions (mm, deg), scalars the corrections (minus the error) to be added to the commands "
      "(um, urad); linear in every position between the nodes, the end values outside";
  format.write = [format](const Machine& machine, const ErrorSet& errors, const WriterRequest& request) {
    return make_lattice(true, format, machine, errors, request);
  };
  return format;
}

}  // namespace abbe
