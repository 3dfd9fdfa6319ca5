// Tables of other programs and files of instruments: any bytes give a table or an InputError. The mapping that was
// proposed gives the same bytes again, and readers of Abbe take them (import_table() reads them back itself).
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>

#include "abbe/formats/text/input_error.h"
#include "abbe/study/imported_file.h"
#include "fuzz_machine_data.h"

namespace {

/// The first byte says what is known of the table.
abbe::ImportRequest request_of(std::uint8_t choice) {
  abbe::ImportRequest request;
  request.file = "fuzz.txt";
  request.threads = 1;
  if ((choice & 1U) != 0) request.machine = fuzz_machine();
  if ((choice & 2U) != 0) request.kind = abbe::ImportKind::points;
  if ((choice & 4U) != 0) request.hints.layout.decimal = abbe::DecimalMark::comma;
  if ((choice & 8U) != 0) request.hints.length_unit = "inch";
  if ((choice & 16U) != 0) request.hints.angle_unit = "gon";
  constexpr unsigned kByContents = 2;
  const unsigned form = choice >> 5U;
  if (form != kByContents) request.format = abbe::import_format_names()[form < kByContents ? form : form - 1];
  return request;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  abbe::ImportRequest request = request_of(data[0]);
  std::optional<abbe::ImportedTable> found;
  try {
    abbe::ForeignTextOptions options;
    options.largest_unpacked = std::size_t{1} << 16;
    request.text = abbe::decode_foreign_text(bytes, request.file, options);
    found = abbe::import_table(request);
  } catch (const abbe::InputError&) {
  }
  if (found) {
    if (abbe::imported_table_text(*found).empty()) std::abort();
    request.kind.reset();
    request.format.clear();
    try {
      request.mapping = abbe::parse_import_mapping(abbe::imported_mapping_text(*found), "fuzz.import.toml");
      if (abbe::import_table(request).rows.csv != found->rows.csv) std::abort();
    } catch (const abbe::InputError&) {
      std::abort();
    }
  }
  try {
    request.mapping = abbe::parse_import_mapping(std::string(bytes), "fuzz.import.toml");
  } catch (const abbe::InputError&) {
  }
  return 0;
}
