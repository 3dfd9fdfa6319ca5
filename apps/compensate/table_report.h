#pragma once

#include <string>
#include <vector>

#include "abbe/controls/control_table.h"
#include "abbe/machine/machine.h"
#include "abbe/report/partial_errors.h"

namespace abbe {

/// What `abbe compensate table` says of tables; valid as long as what it refers to.
struct TableReport {
  const Machine& machine;
  const ControlTables& made;
  PartialErrors partial;             ///< what the errors file does not state
  std::vector<std::string> written;  ///< names of files
};

void print_table_report(const TableReport& report);
void print_table_json(const TableReport& report);

}  // namespace abbe
