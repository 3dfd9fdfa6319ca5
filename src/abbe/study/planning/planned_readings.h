#pragma once

#include <cstdint>

#include "abbe/formats/readings/channel_file.h"
#include "abbe/formats/study/study.h"
#include "abbe/instruments/instrument.h"

namespace abbe {

/// Seed of one plan: every plan of every set-up has numbers of its own, whatever stands beside it in the study.
std::uint64_t plan_seed(const Study& study, std::size_t setup, std::size_t plan);

/// Poses of a plan of one of the kinds grid, line, random, spiral and step diagonal, repeated as it says.
PoseList plan_poses(const Machine& machine, const MeasurementPlan& plan, std::uint64_t seed);

/// Readings that a plan asks for, in their order.
struct PlannedReadings {
  InstrumentReadings readings;
  std::size_t per_pose = 0;  ///< as InstrumentSimulationOptions::readings_per_pose
};

/// What one plan would measure with an instrument: each pose with each target and each of its inputs.
/// @param channels  states by the times of poses; plans that are no file of poses have no times
/// @throws InputError if a pose is out of reach
PlannedReadings planned_readings(const Machine& machine, const Setup& setup, const MeasurementPlan& plan,
                                 std::uint64_t seed, const ChannelUse& channels = {});

}  // namespace abbe
