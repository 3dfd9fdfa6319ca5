#pragma once

#include "abbe/instruments/tracker_observations.h"
#include "abbe/instruments/tracker_simulation.h"
#include "abbe/study/campaign.h"

namespace abbe {

/// Laser trackers of one set-up with their readings.
class TrackerCampaign : public CampaignSetup {
 public:
  TrackerSetup start;  ///< stations and reflectors as the identification starts with them
  TrackerSetup truth;  ///< simulation: as they really are
  TrackerReadings readings;
  TrackerReadings exact;                            ///< simulation: the same readings without noise and outliers
  std::vector<Eigen::Vector3d> offset_uncertainty;  ///< [reflectors] of the study; 0: not known beforehand
  std::vector<std::string> contradictions;          ///< in words, where a file of readings and the study differ

  const PoseList& poses() const override { return readings.poses; }
  const std::vector<double>& time_s() const override { return readings.time_s; }
  const std::vector<std::string>& points() const override { return readings.point_name; }
  std::string readings_text(const Machine& machine) const override;
  ReadingFacts facts() const override;
  void find_start(const Machine& machine, std::vector<std::string>& warnings, std::vector<std::string>& notes) override;
  std::unique_ptr<Observations> observations(const Machine& machine, const ErrorSet& errors) const override;
  std::unique_ptr<Observations> exact_observations(const Machine& machine, const ErrorSet& errors) const override;
  std::vector<KnownUnknown> known_unknowns() const override;
  std::vector<KnownUnknown> true_unknowns() const override;

 private:
  std::vector<KnownUnknown> known_offsets(const TrackerSetup& from) const;
};

/// Stations and reflectors of a tracker's set-up; `truth` chooses the true values of a simulation.
TrackerSetup tracker_setup(const Setup& setup, bool truth);

/// Reads or simulates the readings of one set-up. @param truth  null: measured
/// @throws InputError
std::shared_ptr<CampaignSetup> gather_tracker(const Study& study, std::size_t setup, const ErrorSet* truth,
                                              const ProgressCallback& progress);

/// Readings of the first set-up's instrument that are for validation only, from the study's held-out file.
/// @throws InputError
TrackerReadings read_held_out(const Study& study, const TrackerCampaign& campaign);

}  // namespace abbe
