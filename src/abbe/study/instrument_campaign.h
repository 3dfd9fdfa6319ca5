#pragma once

#include <memory>

#include "abbe/instruments/instrument.h"
#include "abbe/study/campaign.h"

namespace abbe {

/// One instrument (any but the tracker) with its readings.
class InstrumentCampaign : public CampaignSetup {
 public:
  std::shared_ptr<const Instrument> device;  ///< with the stated values
  std::vector<double> start;                 ///< [quantities] values the identification starts with
  InstrumentReadings readings;
  InstrumentReadings exact;   ///< simulation: the same readings without noise and outliers
  std::vector<double> truth;  ///< simulation: [quantities] what they really are

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
  std::unique_ptr<Observations> observe(const Machine& machine, const ErrorSet& errors,
                                        const InstrumentReadings& from) const;
};

/// Reads or simulates the readings of one set-up. In a simulation a number that is known within an uncertainty really
/// is what the study states as true, or else drawn from that uncertainty.
/// @param truth  null: measured
/// @throws InputError
std::shared_ptr<CampaignSetup> gather_instrument(const Study& study, std::size_t setup, const ErrorSet* truth);

/// What one plan would measure with an instrument: each pose with each target and each of its inputs.
/// @throws InputError if a pose is out of reach
InstrumentReadings planned_readings(const Machine& machine, const Setup& setup, const MeasurementPlan& plan,
                                    std::uint64_t seed);

}  // namespace abbe
