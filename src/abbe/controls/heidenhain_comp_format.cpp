#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "abbe/compensate/point_correction.h"
#include "abbe/compensate/tables/table_nodes.h"
#include "abbe/controls/described_errors.h"
#include "abbe/controls/description_rows.h"
#include "abbe/controls/error_model_writer.h"
#include "abbe/controls/table_format.h"
#include "abbe/formats/controls/table_heidenhain.h"
#include "abbe/formats/text/input_error.h"

namespace abbe {

TableFormat heidenhain_format();

namespace {

constexpr const char* kCompName = "heidenhain-kinematics-comp";
constexpr const char* kDescriptionFile = "KINEMATICS.TAB";
constexpr double kCompStep = 1e-3;  // mm

/// Component of the own column: along a linear axis, about a rotary one.
Component own_component(const DescribedAxis& axis) { return static_cast<Component>(axis.coordinate); }

/// The tables of one axis on their way to a file, with what is said of them.
class CompTables {
 public:
  CompTables(const Machine& machine, const ErrorSet& errors, const WriterRequest& request, std::size_t described)
      : machine_(machine),
        request_(request),
        described_(described),
        axis_(described_axes(machine, errors, kCompName)[described]),
        rotary_(machine.axes[axis_.axis].kind == AxisKind::rotary),
        travel_(known_travel(machine, errors, axis_.axis)),
        rows_(machine, errors, axis_) {
    spacing_.from = travel_.from;
    spacing_.to = travel_.to;
    spacing_.most = request.most_nodes > 0 ? std::min(request.most_nodes, kHeidenhainPoints) : kHeidenhainPoints;
    spacing_.step_multiple = rotary_ ? 0 : kCompStep;
    spacing_.kinks = kinks_of(errors, axis_.axis);
    for (std::size_t f = 0; f < DescribedErrors::kCount; ++f) {
      spacing_.tolerance.push_back(is_angle(f) ? request.tolerance_rad : request.tolerance_mm);
    }
  }

  /// @returns false where there is nothing to write
  bool make(ComponentTable& table, std::vector<WrittenTable>& summaries) const {
    const SampledFunctions functions = [&](std::span<const double> positions,
                                           std::vector<std::vector<double>>& values) { values = rows_.at(positions); };
    const TableNodes nodes =
        request_.nodes > 0 ? nodes_at(functions, spacing_, request_.nodes) : choose_nodes(functions, spacing_);
    table.axis = axis_.axis;
    bool any = false;
    for (std::size_t f = 0; f < DescribedErrors::kCount; ++f) {
      const std::string name = name_of(f);
      if (request_.left_out.count(name) != 0 || !is_shown(f, nodes.values[f])) continue;
      AxisTable column = column_of(f, nodes);
      WrittenTable summary = summary_of(name, column.positions, column.forward);
      summary.step_is_angle = rotary_;
      summary.is_angle = is_angle(f);
      summary.interpolation_error = nodes.error[f];
      summary.within = nodes.error[f] <= spacing_.tolerance[f];
      summary.values = [&machine = machine_, f, described = described_,
                        positions = summary.positions](const ErrorSet& errors) {
        const DescribedAxis axis = described_axes(machine, errors, kCompName)[described];
        return DescribedErrors(machine, errors, axis).at(positions)[f];
      };
      summaries.push_back(std::move(summary));
      (f == 0 ? table.own : table.columns.at(f - 1)) = std::move(column);
      any = true;
    }
    return any;
  }

 private:
  bool is_angle(std::size_t f) const { return f == 0 ? rotary_ : f >= 4; }
  /// Of the row along (about) the letter of the axis itself products of angles are left, which a tilted axis exceeds.
  bool is_shown(std::size_t f, const std::vector<double>& values) const {
    const bool own_row = f > 0 && static_cast<Component>(f - 1) == own_component(axis_);
    return std::any_of(values.begin(), values.end(), [&](double value) {
      return own_row ? std::abs(value) > spacing_.tolerance[f] : shown_in_row(is_angle(f) ? 3 : 0, value);
    });
  }
  std::string name_of(std::size_t f) const {
    const Component own = own_component(axis_);
    const Component component = f == 0 ? own : static_cast<Component>(f - 1);
    const std::string name = error_motion_name(machine_, axis_.axis, component);
    return f > 0 && component == own ? name + " in C" + std::to_string(f) : name;
  }
  AxisTable column_of(std::size_t f, const TableNodes& nodes) const {
    AxisTable column;
    column.input = column.output = axis_.axis;
    column.positions = nodes.positions;
    column.forward = nodes.values[f];
    // A table that repeats itself has one value where it meets itself.
    if (repeats() && std::abs(column.forward.back() - column.forward.front()) <= spacing_.tolerance[f]) {
      column.forward.back() = column.forward.front();
      column.modulo = true;
    }
    column.reverse = column.forward;
    return column;
  }
  bool repeats() const { return travel_.whole_turn; }

  const Machine& machine_;
  const WriterRequest& request_;
  std::size_t described_;  ///< index into described_axes()
  DescribedAxis axis_;
  bool rotary_;
  KnownTravel travel_;
  NodeSpacing spacing_;
  DescribedErrors rows_;
};

/// The set of files read back, as the control has it.
std::vector<ComponentTable> written_tables(const Machine& machine, const ErrorSet& errors, const WriterRequest& request,
                                           const std::vector<ComponentTable>& tables, WrittenTables& made) {
  const double sign = request.negate ? -1 : 1, own_sign = request.negate_own ? 1 : -1;
  std::vector<ComponentTable> read;
  std::vector<HeidenhainAssignment> assigned;
  for (const ComponentTable& table : tables) {
    const std::string name = machine.axes[table.axis].name.substr(0, 1) + ".COM";
    const std::string text = heidenhain_component_text(table, name, request.names, own_sign, sign);
    ComponentTable again = parse_heidenhain_component(text, name, table.axis, request.names, own_sign, sign);
    // A rotary axis has entries from 0 to 360 degrees, and repeats itself.
    const bool modulo = machine.axes[table.axis].endless && known_travel(machine, errors, table.axis).whole_turn;
    if (again.own) again.own->modulo = modulo;
    for (std::optional<AxisTable>& column : again.columns) {
      if (column) column->modulo = modulo;
    }
    read.push_back(std::move(again));
    assigned.push_back({table_axis(request.names, table.axis).name, name});
    made.files.push_back({name, text});
  }
  made.files.push_back({"CONFIG.CMA", heidenhain_assignment_text(assigned)});
  return read;
}

void count_entries(const std::vector<KinematicsRow>& rows, WrittenTables& made) {
  const KinematicsCount count = kinematics_count(rows);
  made.remarks.push_back(fmt::format("{}: {}", kDescriptionFile, kinematics_room(count)));
  if (kinematics_fits(count)) return;
  made.problems.push_back("the kinematics description has no room: " + kinematics_room(count));
}

WrittenTables make_kinematics_comp(const Machine& machine, const ErrorSet& errors, const WriterRequest& request) {
  if (errors.composition.first_order) {
    throw InputError({.field = "--for"}, "the rows of this format are rotations, and first-order errors are not",
                     "errors that are not `first_order`");
  }
  const ErrorSet written = wanted_errors(machine, errors, request);
  const std::vector<DescribedAxis> axes = described_axes(machine, written, kCompName);
  WrittenTables made;
  std::vector<ComponentTable> tables;
  for (std::size_t k = 0; k < axes.size(); ++k) {
    const auto of_axis = [&](const auto& error) { return error.axis == axes[k].axis; };
    if (std::none_of(written.motions.begin(), written.motions.end(), of_axis) &&
        std::none_of(written.locations.begin(), written.locations.end(), of_axis)) {
      continue;
    }
    ComponentTable table;
    if (CompTables(machine, written, request, k).make(table, made.tables)) tables.push_back(std::move(table));
  }
  for (const LocationError& location : written.locations) {
    // The zero position is in the own column.
    if (is_zero_position_error(machine.axes[location.axis], location.component)) continue;
    made.tables.push_back(summary_of(machine, location));
  }
  std::vector<KinematicsRow> rows = description_rows(machine, written, tables, kCompName);
  count_entries(rows, made);
  if (request.nodes == 0 && !made.tables.empty() && made.problems.empty()) {
    const double sign = request.negate ? -1 : 1;
    const std::string text = heidenhain_kinematics_text(rows, kDescriptionFile, request.names, sign);
    rows = parse_heidenhain_kinematics(text, kDescriptionFile, request.names, sign);
    if (!tables.empty()) tables = written_tables(machine, written, request, tables, made);
    made.files.push_back({kDescriptionFile, text});
  }
  made.correction = std::make_unique<DescribedCorrection>(machine, rows, std::move(tables));
  return made;
}

}  // namespace

TableFormat heidenhain_comp_format() {
  using enum TableSetting;
  TableFormat format;
  format.name = kCompName;
  format.control = "HEIDENHAIN iTNC 530";
  format.kind = TableKind::error_model;
  format.what =
      "KinematicsComp of HEIDENHAIN iTNC 530: kinematics description with COMPTAB, and the tables it refers to";
  format.convention =
      "rows move the frame from the tool reference point to the table; C1 to C6 and numbers of COMPTAB are these "
      "movements, mm or degrees, in front of each axis; the column of an axis itself is its error (actual minus "
      "nominal); straight lines between points; the control corrects X, Y and Z from the chain, and every axis by "
      "itself";
  format.unverified =
      "the sign of COMPTAB and C1 to C6 (--negate) and that of the own columns (--negate-own); the sense of rows and "
      "axes, which follows from one example; the form of a reference (A1C2: axis 1, column C2); header, end and "
      "columns of the texts; degrees; that tables are looked up at the command; what holds outside their ends";
  format.takes = {negate, negate_own, names, axes, tolerance_mm, tolerance_rad, most_nodes};
  format.axis_names = "number of the axis, counted from 1";
  format.default_name = [](std::size_t index, const Axis&) { return std::to_string(index + 1); };
  format.backlash = heidenhain_format().backlash;
  format.most_nodes = kHeidenhainPoints;
  format.cannot =
      "tool offset errors are not written; rotary axes correct their own errors, and X, Y and Z correct the point, so "
      "tilts of the tool remain";
  format.write = make_kinematics_comp;
  return format;
}

}  // namespace abbe
