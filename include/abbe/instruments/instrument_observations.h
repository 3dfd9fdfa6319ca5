#pragma once

#include <memory>

#include "abbe/instruments/instrument.h"

namespace abbe {

/// Readings of any Instrument as weighted residuals of the machine's errors and the quantities of its set-up.
///
/// Unknowns are the quantities that are not exact, in their order. Residual = (measured - modelled) / standard
/// uncertainty, the uncertainty from the data where they state it, else from the instrument's noise model; it stays
/// fixed. Where the data state covariances, residuals are W (measured - modelled) with W'W the inverse of the reading's
/// covariance; else the components of one reading are taken as uncorrelated. Known numbers (Knowledge::within) enter
/// the identification as priors: see setup_priors() of the problem.
class InstrumentObservations : public Observations {
 public:
  /// @param instrument  not changed; its quantities are the start values
  /// @throws std::invalid_argument as check_readings()
  InstrumentObservations(const Machine& machine, const ErrorSet& errors, std::shared_ptr<const Instrument> instrument,
                         InstrumentReadings readings);
  ~InstrumentObservations() override;

  std::string name() const override;
  std::size_t reading_count() const override;
  int rows() const override;
  const std::vector<ReadingComponent>& components() const override;
  const std::vector<SetupUnknown>& unknowns() const override;
  std::vector<double> unknown_values() const override;
  std::vector<double> positions(std::size_t reading) const override;
  std::vector<double> deviation(std::size_t reading) const override;
  void deviations(std::size_t first, std::size_t count, double* out) const override;
  void set_parameters(std::span<const double> machine, std::span<const double> setup) override;
  void evaluate(std::size_t first, std::size_t count, std::span<const std::size_t> machine_parameters,
                std::span<const std::size_t> setup_parameters, double* residuals, double* jacobian,
                std::size_t stride) const override;
  std::optional<FactoredColumns> column_factors(std::span<const std::size_t> machine_parameters,
                                                std::span<const std::size_t> setup_parameters) const override;
  void evaluate_factored(std::size_t first, std::size_t count, std::span<const std::size_t> machine_parameters,
                         std::span<const std::size_t> setup_parameters, double* residuals,
                         const JacobianFactors& factors) const override;
  bool displacement_rows(std::size_t first, std::size_t count, double* rows_out) const override;
  std::vector<FurtherReadings> further_readings(const Machine& machine, const ErrorSet& errors) const override;

  const Instrument& instrument() const;
  const InstrumentReadings& readings() const;
  /// Index into Instrument::quantities() of an unknown.
  std::size_t quantity_of(std::size_t unknown) const;
  /// Present values of all quantities, exact ones included.
  std::vector<double> quantity_values() const;
  /// What the instrument would read at the present point, [components][count], mm or rad.
  std::vector<std::vector<double>> modelled() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace abbe
