#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "abbe/formats/csv_reader.h"
#include "abbe/formats/measurement_file.h"
#include "abbe/instruments/instrument.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Reads readings of any instrument from CSV: axis columns (X_mm, C_deg), `item` (not needed if there is one), the
/// instrument's inputs and components with units (length_mm), optional standard uncertainties u_length_um of all
/// components, optional time_s. Every row counts or is an error; rows keep their order. @throws InputError
InstrumentReadings read_instrument_readings(const std::filesystem::path& path, const Machine& machine,
                                            const Instrument& instrument, const MeasurementOptions& options = {});
/// The same from text. @param file  name for messages
InstrumentReadings parse_instrument_readings(std::string_view text, const std::string& file, const Machine& machine,
                                             const Instrument& instrument, const MeasurementOptions& options = {});

/// CSV text of readings: mm and deg, angles of readings in arcsec, uncertainties in um and arcsec; shortest decimals.
std::string instrument_readings_text(const Machine& machine, const Instrument& instrument,
                                     const InstrumentReadings& readings);

}  // namespace abbe
