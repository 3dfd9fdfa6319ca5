#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "abbe/controls/control_table.h"
#include "abbe/machine/machine.h"
#include "abbe/report/evaluations/partial_errors.h"

namespace abbe {

/// What `abbe compensate table` says of tables; valid as long as what it refers to.
struct TableReport {
  const Machine& machine;
  const ControlTables& made;
  PartialErrors partial;             ///< what the errors file does not state
  std::vector<std::string> written;  ///< names of files
};

/// For people; complete lines.
std::string table_text(const TableReport& report);

/// For programs; units in the keys.
nlohmann::ordered_json table_json(const TableReport& report);

}  // namespace abbe
