#pragma once

// Internal to formats: the readers of instrument_formats(), each in a file of its own. Where the forms are described:
// docs/import.md.
#include <optional>
#include <string>
#include <string_view>

#include "abbe/formats/import/instrument_format.h"

namespace abbe {

std::optional<Recognition> recognise_renishaw_laser(std::string_view text);
InstrumentTable read_renishaw_laser(std::string_view text, const std::string& file, const ImportHints& hints);

std::optional<Recognition> recognise_renishaw_ballbar(std::string_view text);
InstrumentTable read_renishaw_ballbar(std::string_view text, const std::string& file, const ImportHints& hints);

std::optional<Recognition> recognise_linuxcnc_probe(std::string_view text);
InstrumentTable read_linuxcnc_probe(std::string_view text, const std::string& file, const ImportHints& hints);

std::optional<Recognition> recognise_heidenhain_table(std::string_view text);
InstrumentTable read_heidenhain_table(std::string_view text, const std::string& file, const ImportHints& hints);

std::optional<Recognition> recognise_qif_results(std::string_view text);
InstrumentTable read_qif_results(std::string_view text, const std::string& file, const ImportHints& hints);

std::optional<Recognition> recognise_mtconnect_streams(std::string_view text);
InstrumentTable read_mtconnect_streams(std::string_view text, const std::string& file, const ImportHints& hints);

std::optional<Recognition> recognise_mtconnect_devices(std::string_view text);
InstrumentTable read_mtconnect_devices(std::string_view text, const std::string& file, const ImportHints& hints);

std::optional<Recognition> recognise_mtconnect_temperatures(std::string_view text);
InstrumentTable read_mtconnect_temperatures(std::string_view text, const std::string& file, const ImportHints& hints);
/// Whether an answer of an agent has temperatures and no positions.
bool has_only_temperatures(std::string_view text);

std::optional<Recognition> recognise_ecmc_positioning(std::string_view text);
InstrumentTable read_ecmc_positioning(std::string_view text, const std::string& file, const ImportHints& hints);

std::optional<Recognition> recognise_dmis_output(std::string_view text);
InstrumentTable read_dmis_output(std::string_view text, const std::string& file, const ImportHints& hints);

}  // namespace abbe
