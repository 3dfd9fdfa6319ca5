#pragma once

// For formats and study: the parts of a study file.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "abbe/formats/study/study.h"
#include "abbe/formats/text/toml_table.h"

namespace abbe {

/// @param later  the readings are still to be planned, or given: neither plans nor data are needed
Setup read_setup(TomlTable& table, const std::filesystem::path& folder, const Machine& machine, bool simulated,
                 bool later);
/// Keys `ignore` and `columns` of a file that Abbe did not write.
ColumnMapping read_column_mapping(TomlTable& table);

/// Keys `channels`, `channel` and `lag_start` of a study or a set-up.
ChannelPlan read_channel_plan(TomlTable& table, const std::filesystem::path& folder, const Machine& machine);

/// Table `drift` of a set-up.
std::optional<DriftPlan> read_drift(TomlTable& setup, bool simulated);

PlanningStudy read_planning(TomlTable& table, const Machine& machine, const std::filesystem::path& folder);
/// @param simulation  of the study, or null
IdentificationPlan read_identification(TomlTable& table, const std::filesystem::path& folder, const Machine& machine,
                                       const Simulation* simulation);

/// Tables `expansion` of what is identified; appends their terms to the motions of the plan.
void read_identified_expansions(TomlTable& identify, const Machine& machine, const Simulation* simulation,
                                IdentificationPlan& plan);

/// What a plan may name: targets ("reflectors" of a tracker, "items" of other instruments) and stations (tracker only).
struct PlanNames {
  std::string key;  ///< of the targets in the file
  std::string one;  ///< a single target in words
  std::vector<std::string> targets;
  std::vector<std::string> stations;
};

MeasurementPlan read_plan(TomlTable& table, const std::filesystem::path& folder, const Machine& machine,
                          const PlanNames& names);

/// Which way ranges of axes may be written.
enum class RangeOrder { rising, either };

/// Table `axis` with one table per axis: `range` and `count`, or `at`. Axes that are not named stay fixed.
std::vector<AxisRange> read_axis_ranges(TomlTable& parent, const Machine& machine, bool with_counts,
                                        RangeOrder order = RangeOrder::rising);

}  // namespace abbe
