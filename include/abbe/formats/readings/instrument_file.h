#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/readings/measurement_file.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/instruments/instrument.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// What one file of readings says.
struct InstrumentFile {
  std::shared_ptr<const Instrument> device;  ///< with what the file says of it: offsets of reflectors
  InstrumentReadings readings;
  std::vector<std::string> contradictions;  ///< in words, where the file and the study differ
};

/// How the readings of an instrument are read and written.
struct InstrumentFileForm {
  /// @param setup            name of the set-up, for messages
  /// @param noise_from_data  the uncertainties of the file count and have to be there; else they are passed over
  InstrumentFile (*read)(const std::filesystem::path& path, const Machine& machine,
                         const std::shared_ptr<const Instrument>& device, const std::string& setup,
                         bool noise_from_data, const MeasurementOptions& options);
  /// The same for text. @param file  name for messages
  InstrumentFile (*parse)(std::string_view content, const std::string& file, const Machine& machine,
                          const std::shared_ptr<const Instrument>& device, const std::string& setup,
                          bool noise_from_data, const MeasurementOptions& options);
  std::string (*text)(const Machine& machine, const Instrument& device, const InstrumentReadings& readings);
  constexpr InstrumentFileForm();
  constexpr InstrumentFileForm(decltype(read) how, decltype(parse) of_text, decltype(text) back)
      : read(how), parse(of_text), text(back) {}
};

/// Reads readings of any instrument from CSV: axis columns (X_mm, C_deg), `item` (not needed if there is one), the
/// instrument's inputs and components with units (length_mm), optional standard uncertainties u_length_um of all
/// components, optional time_s. Every row counts or is an error; rows keep their order. @throws InputError
InstrumentReadings read_instrument_readings(const std::filesystem::path& path, const Machine& machine,
                                            const Instrument& instrument, const MeasurementOptions& options = {});
/// The same from text. @param file  name for messages
InstrumentReadings parse_instrument_readings(std::string_view text, const std::string& file, const Machine& machine,
                                             const Instrument& instrument, const MeasurementOptions& options = {});

/// Reads a file in the form of an instrument, or the same columns from a Parquet or Arrow IPC file.
/// @throws InputError as the form does; of column files with the number of the row, from 1
InstrumentFile read_readings_file(const InstrumentFileForm& form, const std::filesystem::path& path,
                                  const Machine& machine, const std::shared_ptr<const Instrument>& device,
                                  const std::string& setup, bool noise_from_data, const MeasurementOptions& options);

/// CSV text of readings: mm and deg, angles of readings in arcsec, uncertainties in um and arcsec; shortest decimals.
std::string instrument_readings_text(const Machine& machine, const Instrument& instrument,
                                     const InstrumentReadings& readings);

/// As InstrumentFileForm::read, of every instrument without a form of its own.
InstrumentFile read_instrument_file(const std::filesystem::path& path, const Machine& machine,
                                    const std::shared_ptr<const Instrument>& device, const std::string& setup,
                                    bool noise_from_data, const MeasurementOptions& options);

/// As InstrumentFileForm::parse.
InstrumentFile parse_instrument_file(std::string_view text, const std::string& file, const Machine& machine,
                                     const std::shared_ptr<const Instrument>& device, const std::string& setup,
                                     bool noise_from_data, const MeasurementOptions& options);

/// Whether a reading of the instrument carries its orientation as a quaternion: inputs qw, qx, qy, qz.
bool has_orientation(const Instrument& instrument);

/// A reading whose quaternion is none of a rotation.
struct BadOrientation {
  std::size_t reading = 0;
  double length = 0;  ///< of the quaternion; NaN if a number of it is missing
};

/// The first reading whose quaternion is not of length 1 within 1e-3; nothing if the instrument reads no orientations.
std::optional<BadOrientation> first_bad_orientation(const Instrument& instrument, const InstrumentReadings& readings);

/// As read_instrument_file(), of readings that somebody has already.
/// @param setup  name of the set-up, for messages
/// @throws InputError for another number of axes, items or components, commands outside an axis's travel, numbers that
///   are not finite, ranges that are not above zero, orientations that were not measured, and missing uncertainties
InstrumentFile given_readings(const InstrumentReadings& readings, const Machine& machine,
                              const std::shared_ptr<const Instrument>& device, const std::string& setup,
                              bool noise_from_data);

constexpr InstrumentFileForm::InstrumentFileForm()
    : read(read_instrument_file), parse(parse_instrument_file), text(instrument_readings_text) {}

}  // namespace abbe
