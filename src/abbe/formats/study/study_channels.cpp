#include <fmt/format.h>

#include <optional>

#include "abbe/formats/study/study_parts.h"
#include "abbe/machine/state.h"

namespace abbe {
namespace {

ChannelFile read_channel_file(TomlTable& table, const std::filesystem::path& folder) {
  ChannelFile channel;
  channel.file = folder / table.text("file");
  channel.mapping = read_column_mapping(table);
  channel.largest_gap_s = table.optional_number("largest_gap", Quantity::time);
  if (channel.largest_gap_s && !(*channel.largest_gap_s > 0)) {
    table.fail_quantity("largest_gap", Quantity::time, "is not above zero", "a time, for example largest_gap_s = 600");
  }
  table.finish();
  return channel;
}

/// Key `column_degC` of the table `lag_start`.
std::size_t lag_of_key(const TomlTable& table, const std::string& key, const Machine& machine) {
  std::string known;
  for (std::size_t j = 0; j < machine.states.size(); ++j) {
    if (machine.states[j].kind != StateKind::lag) continue;
    const std::string column = state_column(machine.states[j]);
    if (column == key) return j;
    known += (known.empty() ? "" : ", ") + column;
  }
  table.fail(key, "is not a state of kind \"lag\" with its unit",
             known.empty() ? "a machine that has such a state" : known);
}

}  // namespace

ColumnMapping read_column_mapping(TomlTable& table) {
  ColumnMapping mapping;
  mapping.ignore = table.texts_or_none("ignore");
  mapping.ignored_by = "`ignore`";
  if (auto columns = table.optional_table("columns")) {
    for (const std::string& ours : columns->keys()) mapping.columns.emplace(ours, columns->text(ours));
  }
  return mapping;
}

ChannelPlan read_channel_plan(TomlTable& table, const std::filesystem::path& folder, const Machine& machine) {
  ChannelPlan plan;
  for (const std::string& file : table.texts_or_none("channels")) plan.files.push_back({folder / file, {}, {}});
  for (TomlTable& channel : table.tables("channel")) plan.files.push_back(read_channel_file(channel, folder));
  if (auto starts = table.optional_table("lag_start")) {
    for (const std::string& key : starts->keys()) {
      plan.lag_start[lag_of_key(*starts, key, machine)] = starts->number(key, Quantity::dimensionless);
    }
  }
  return plan;
}

}  // namespace abbe
