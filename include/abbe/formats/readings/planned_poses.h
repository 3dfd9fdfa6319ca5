#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/errors/poses.h"
#include "abbe/formats/readings/channel_file.h"
#include "abbe/formats/study/study.h"

namespace abbe {

/// Poses of a file at which a set-up is measured, in the order of the file.
struct PlannedPoses {
  PoseList poses;
  std::vector<std::size_t> station;  ///< [poses] index into Instrument::station_names(); empty where it has none
  std::vector<double> time_s;        ///< [poses] or empty
  std::vector<std::size_t> target;   ///< [poses] into target_names(); empty: the file does not say, so all of the plan
};

/// CSV with a column for every axis and optionally `setup` (rows of other set-ups are passed over), `station` and
/// `reflector` or `item`, which may be called `target` too: what `abbe plan -o` writes; also `time_s` and states. Other
/// columns are refused.
/// @throws InputError for names that the set-up does not have, poses outside a travel, no pose for the set-up
PlannedPoses parse_planned_poses(std::string_view text, const std::string& file, const Machine& machine,
                                 const Setup& setup, const ChannelUse& channels = {});
PlannedPoses read_planned_poses(const std::filesystem::path& path, const Machine& machine, const Setup& setup,
                                const ChannelUse& channels = {});

}  // namespace abbe
