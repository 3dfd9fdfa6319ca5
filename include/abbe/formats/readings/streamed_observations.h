#pragma once

#include <memory>

#include "abbe/errors/error_set.h"
#include "abbe/formats/readings/reading_shards.h"
#include "abbe/instruments/observations.h"

namespace abbe {

/// Readings of any instrument that are read from their files whenever they are evaluated.
///
/// Memory does not grow with the number of readings: a few thousand for each thread are held at a time. Residuals are
/// those that the readings would have in memory.
class StreamedObservations : public Observations {
 public:
  /// @param start  the instrument with the set-up that the identification starts with; its items are those of the
  ///   shards' device
  StreamedObservations(const Machine& machine, const ErrorSet& errors, std::shared_ptr<const Instrument> start,
                       std::shared_ptr<const ReadingShards> shards);
  ~StreamedObservations() override;

  std::string name() const override;
  std::size_t reading_count() const override;
  int rows() const override;
  const std::vector<ReadingComponent>& components() const override;
  const std::vector<SetupUnknown>& unknowns() const override;
  std::vector<double> unknown_values() const override;
  std::vector<double> positions(std::size_t reading) const override;
  std::vector<double> deviation(std::size_t reading) const override;
  void set_parameters(std::span<const double> machine, std::span<const double> setup) override;
  /// @throws InputError if a file has changed since it was checked
  void evaluate(std::size_t first, std::size_t count, std::span<const std::size_t> machine_parameters,
                std::span<const std::size_t> setup_parameters, double* residuals, double* jacobian,
                std::size_t stride) const override;
  std::optional<FactoredColumns> column_factors(std::span<const std::size_t> machine_parameters,
                                                std::span<const std::size_t> setup_parameters) const override;
  void evaluate_factored(std::size_t first, std::size_t count, std::span<const std::size_t> machine_parameters,
                         std::span<const std::size_t> setup_parameters, double* residuals,
                         const JacobianFactors& factors) const override;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace abbe
