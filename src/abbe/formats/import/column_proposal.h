#pragma once

// Internal to formats: unit and convention of a column whose place in the file is known.
#include <string>

#include "abbe/formats/import/foreign_unit.h"
#include "abbe/formats/import/proposed_mapping.h"
#include "abbe/formats/import/table_facts.h"

namespace abbe {

/// What is known of a column before its unit and its convention are decided.
struct ColumnCase {
  const ImportColumn* wanted = nullptr;
  const ColumnFacts* file = nullptr;
  std::size_t source = 0;       ///< from 0
  bool own_name = false;        ///< the header is the one that Abbe reads, with Abbe's conventions
  bool unit_in_header = false;  ///< not in a row of its own
  const Axis* axis = nullptr;   ///< whose command it is, or null
  std::string doubt;            ///< of its place
};

ProposedColumn proposed_column(const ColumnCase& asked, const ImportHints& hints);

}  // namespace abbe
