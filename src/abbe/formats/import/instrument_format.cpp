#include "abbe/formats/import/instrument_format.h"

#include <algorithm>

#include "abbe/formats/import/foreign_unit.h"
#include "abbe/formats/import/instrument_readers.h"

namespace abbe {
namespace {

/// The column of the kind that a column becomes, which some kinds have for lengths and for angles.
const ImportColumn& wanted_column(const InstrumentColumn& column, const ForeignUnit* unit,
                                  const std::vector<ImportColumn>& wanted) {
  return *std::find_if(wanted.begin(), wanted.end(), [&](const ImportColumn& one) {
    return one.base == column.base && (unit == nullptr || one.quantity == unit->quantity);
  });
}

}  // namespace

std::vector<ProposedColumn> proposed_columns(const InstrumentTable& table) {
  const std::vector<ImportColumn> wanted = import_columns(table.kind, Machine());
  std::vector<ProposedColumn> columns;
  for (const InstrumentColumn& column : table.columns) {
    const ForeignUnit* const unit = column.unit.empty() ? nullptr : foreign_unit_named(column.unit);
    ProposedColumn proposed;
    proposed.column.name =
        import_header(wanted_column(column, unit, wanted), unit == nullptr ? std::string_view() : unit->suffix);
    proposed.column.from = column.name;
    proposed.column.unit = column.unit;
    proposed.source = columns.size();
    proposed.reason = column.reason;
    proposed.doubts = column.doubts;
    columns.push_back(std::move(proposed));
  }
  return columns;
}

const std::vector<InstrumentFormat>& instrument_formats() {
  static const std::vector<InstrumentFormat> formats = {
      {"renishaw-laser", "file of a Renishaw laser interferometer", recognise_renishaw_laser, read_renishaw_laser},
      {"renishaw-ballbar", "file of a Renishaw ball bar", recognise_renishaw_ballbar, read_renishaw_ballbar},
      {"qif", "file of QIF results", recognise_qif_results, read_qif_results},
      {"mtconnect", "answer of an MTConnect agent", recognise_mtconnect_streams, read_mtconnect_streams},
      {"dmis", "DMIS output file", recognise_dmis_output, read_dmis_output},
      {"heidenhain-table", "table of a Heidenhain control", recognise_heidenhain_table, read_heidenhain_table},
      {"linuxcnc-probe", "probe log of LinuxCNC", recognise_linuxcnc_probe, read_linuxcnc_probe},
      {"ecmc-positioning", "file of positioning readings of ecmc", recognise_ecmc_positioning, read_ecmc_positioning},
      {"mtconnect-temperatures", "answer of an MTConnect agent", recognise_mtconnect_temperatures,
       read_mtconnect_temperatures},
      {"mtconnect-devices", "description of devices by an MTConnect agent", recognise_mtconnect_devices,
       read_mtconnect_devices},
  };
  return formats;
}

const InstrumentFormat* instrument_format_named(std::string_view name) {
  const std::vector<InstrumentFormat>& formats = instrument_formats();
  const auto found = std::find_if(formats.begin(), formats.end(), [&](const auto& one) { return one.name == name; });
  return found == formats.end() ? nullptr : &*found;
}

std::vector<std::string> import_format_names() {
  std::vector<std::string> names = {std::string(kTableFormat)};
  for (const InstrumentFormat& format : instrument_formats()) names.emplace_back(format.name);
  return names;
}

std::optional<RecognisedFormat> recognise_instrument(std::string_view text) {
  std::optional<RecognisedFormat> possible;
  for (const InstrumentFormat& format : instrument_formats()) {
    std::optional<Recognition> recognition = format.recognise(text);
    if (!recognition) continue;
    if (recognition->certain) return RecognisedFormat{&format, std::move(*recognition)};
    if (!possible) possible = RecognisedFormat{&format, std::move(*recognition)};
  }
  return possible;
}

}  // namespace abbe
