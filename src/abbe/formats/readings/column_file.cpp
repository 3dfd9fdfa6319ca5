#include "abbe/formats/readings/column_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "abbe/formats/files/file_extension.h"
#include "abbe/formats/files/kept_inputs.h"
#include "abbe/formats/text/column_block.h"

namespace abbe {

bool is_column_file(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  std::string begin(6, '\0');
  std::ifstream(path, std::ios::binary).read(begin.data(), static_cast<std::streamsize>(begin.size()));
  if (begin.starts_with("PAR1") || begin == "ARROW1") return true;
  const std::string extension = file_extension(path);
  return extension == ".parquet" || extension == ".arrow" || extension == ".feather";
}

ColumnFile::ColumnFile(std::shared_ptr<ColumnReader> reader, std::size_t number, const ColumnMapping& mapping)
    : reader_(std::move(reader)), number_(number) {
  const ColumnBlockHead head = column_block_head(reader_->columns(number), path().string());
  rows_ = head.rows;
  if (rows_ == 0) throw InputError({.file = path().string()}, "has no rows", "at least one");
  for (std::size_t i = 0; i < head.columns.size(); ++i) {
    const std::vector<std::string>& ignored = mapping.ignore;
    if (std::find(ignored.begin(), ignored.end(), head.columns[i].name) != ignored.end()) continue;
    const std::string& kind = head.columns[i].kind;
    if (kind == "float" || kind == "integer" || kind == "text") columns_.push_back(i);
  }
}

std::string ColumnFile::read(std::size_t first, std::size_t last) const {
  std::string block = reader_->rows(number_, first, last, columns_);
  const std::size_t rows = column_block_head(block, path().string()).rows;
  if (rows == last - first) return block;
  throw InputError({.file = path().string()}, fmt::format("{} rows in place of {}", rows, last - first));
}

InputError at_row_of_columns(const InputError& error, std::size_t first) {
  InputError::Place place = error.place();
  if (place.line < 2) return error;
  place.file += fmt::format(": row {}", first + place.line - 1);
  place.line = 0;
  place.column = 0;
  return InputError(place, error.problem(), error.expected());
}

InstrumentFile read_readings_file(const InstrumentFileForm& form, const std::filesystem::path& path,
                                  const Machine& machine, const std::shared_ptr<const Instrument>& device,
                                  const std::string& setup, bool noise_from_data, const MeasurementOptions& options) {
  if (!is_column_file(path)) return form.read(path, machine, device, setup, noise_from_data, options);
  note_input(path);
  std::string block;
  {
    const ColumnFile file(std::make_shared<ColumnReader>(std::vector{path}), 0, options.mapping);
    block = file.read(0, file.rows());
  }
  try {
    return form.parse(block, path.string(), machine, device, setup, noise_from_data, options);
  } catch (const InputError& error) {
    throw at_row_of_columns(error, 0);
  }
}

}  // namespace abbe
