#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "abbe/identify/linkage/dial_decoupling.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Indications of dials and lasers at the positions of one axis.
struct IndicationTable {
  std::size_t axis = 0;  ///< index into Machine::axes
  AxisIndications readings;
};

/// Standard uncertainties, mm, of probes for which the file states none; 0: it must.
struct IndicationOptions {
  double along_axis = 0;   ///< probes that look along the axis (laser interferometer)
  double across_axis = 0;  ///< all others (dials)
};

/// Reads a CSV of indications: one row per reading with the command of one axis (`X_mm`, `A_deg`), `direction` (X, -X,
/// Y
/// ...: a displacement of the carried body that way raises the indication), `place_x_mm`, `place_y_mm`, `place_z_mm`
/// from the axis's point, `indication_um` and optionally its standard uncertainty `u_um`. A direction at a place is a
/// probe; every probe has one reading at every position. Rows in any order. See docs/formats.md. @throws InputError
IndicationTable read_indications(const std::filesystem::path& path, const Machine& machine,
                                 const IndicationOptions& options = {});
/// The same from text. @param file  name for messages
IndicationTable parse_indications(std::string_view text, const std::string& file, const Machine& machine,
                                  const IndicationOptions& options = {});

/// CSV text with places in mm, indications and uncertainties in um, shortest decimals; reads back to the same bits for
/// lengths, to one unit in the last place for angles. Directions must be those of the machine's axes.
std::string indications_text(const Machine& machine, const IndicationTable& table);

}  // namespace abbe
