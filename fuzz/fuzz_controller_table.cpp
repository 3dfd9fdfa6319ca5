// Tables of controls, the first byte chooses the format: any bytes give tables of finite numbers with increasing
// positions, or an InputError; what was read is written and read again.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "abbe/formats/input_error.h"
#include "abbe/formats/table_linuxcnc.h"
#include "abbe/formats/table_siemens.h"

namespace {

const std::vector<abbe::TableAxisName> kAxes = {{0, "X1", false}, {1, "Y1", false}, {2, "C1", true}};

void check(const std::vector<abbe::AxisTable>& tables) {
  for (const abbe::AxisTable& table : tables) {
    if (table.positions.empty() || table.forward.size() != table.positions.size() ||
        table.reverse.size() != table.positions.size()) {
      std::abort();
    }
    for (std::size_t k = 0; k < table.positions.size(); ++k) {
      if (!std::isfinite(table.forward[k]) || !std::isfinite(table.reverse[k])) std::abort();
      if (k > 0 && !(table.positions[k] > table.positions[k - 1])) std::abort();
    }
    if (!std::isfinite(table.at(1.5))) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  const std::string file = "fuzz";
  try {
    switch (data[0] % 4) {
      case 0:
        check({abbe::parse_linuxcnc(text, file, false, abbe::LinuxCncCompensation::trim)});
        break;
      case 1:
        check({abbe::parse_linuxcnc(text, file, true, abbe::LinuxCncCompensation::actual)});
        break;
      case 2:
        check(abbe::parse_siemens_cec(text, file, kAxes));
        break;
      default:
        check(abbe::parse_siemens_eec(text, file, kAxes));
        break;
    }
  } catch (const abbe::InputError&) {
  }
  return 0;
}
