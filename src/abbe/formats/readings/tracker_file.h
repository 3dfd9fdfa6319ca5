#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "abbe/formats/readings/instrument_file.h"

namespace abbe {

/// Readings of a LaserTracker from a measurement file (read_measurements()), as InstrumentFileForm::read. The returned
/// device measures what the file has, x, y, z or range and angles, and has the file's reflectors and offsets where the
/// study leaves them to it.
/// @param device  a LaserTracker
/// @throws InputError
InstrumentFile read_tracker_file(const std::filesystem::path& path, const Machine& machine,
                                 const std::shared_ptr<const Instrument>& device, const std::string& setup,
                                 bool noise_from_data, const MeasurementOptions& options);

/// The same of text. @param file  name for messages
InstrumentFile parse_tracker_file(std::string_view text, const std::string& file, const Machine& machine,
                                  const std::shared_ptr<const Instrument>& device, const std::string& setup,
                                  bool noise_from_data, const MeasurementOptions& options);

/// The readings of a LaserTracker as a measurement file.
std::string tracker_file_text(const Machine& machine, const Instrument& device, const InstrumentReadings& readings);

}  // namespace abbe
