#include "abbe/formats/readings/streamed_observations.h"

#include <algorithm>
#include <cassert>
#include <mutex>

#include "abbe/geometry/parallel_blocks.h"
#include "abbe/instruments/instrument.h"

namespace abbe {
namespace {

constexpr std::size_t kStreamedTogether = ReadingShards::kTogether;

struct HeldReadings {
  std::size_t number = 0;  ///< of the part of kStreamedTogether readings
  std::size_t used = 0;    ///< when, for throwing out the one that was used longest ago
  std::shared_ptr<const Observations> observations;
};

}  // namespace

struct StreamedObservations::Implementation {
  Machine machine;
  ErrorSet errors;
  std::shared_ptr<const Instrument> start;
  std::shared_ptr<const ReadingShards> shards;
  std::unique_ptr<Observations> pattern;  ///< of one reading: what does not depend on the readings
  std::vector<double> machine_values;
  std::mutex mutex;
  std::vector<HeldReadings> held;
  std::size_t clock = 0;

  std::shared_ptr<const Observations> part(std::size_t number);
};

/// Read outside the lock; two threads that want the same part at the same time read it twice.
std::shared_ptr<const Observations> StreamedObservations::Implementation::part(std::size_t number) {
  {
    const std::lock_guard lock(mutex);
    for (HeldReadings& one : held) {
      if (one.number != number) continue;
      one.used = ++clock;
      return one.observations;
    }
  }
  const std::size_t first = number * kStreamedTogether;
  const std::size_t last = std::min(first + kStreamedTogether, shards->count());
  std::shared_ptr<Observations> made = start->observations(machine, errors, shards->read(first, last));
  made->set_parameters(machine_values, pattern->unknown_values());
  const std::lock_guard lock(mutex);
  const std::size_t most = 2 + 2 * static_cast<std::size_t>(default_thread_count());
  if (held.size() >= most) {
    held.erase(std::min_element(held.begin(), held.end(),
                                [](const HeldReadings& a, const HeldReadings& b) { return a.used < b.used; }));
  }
  held.push_back({number, ++clock, made});
  return made;
}

StreamedObservations::StreamedObservations(const Machine& machine, const ErrorSet& errors,
                                           std::shared_ptr<const Instrument> start,
                                           std::shared_ptr<const ReadingShards> shards)
    : implementation_(
          new Implementation{machine, errors, std::move(start), std::move(shards), nullptr, {}, {}, {}, 0}) {
  Implementation& own = *implementation_;
  own.pattern = own.start->observations(machine, errors, own.shards->read(0, 1));
  own.machine_values = errors.parameters();
}

StreamedObservations::~StreamedObservations() = default;
std::string StreamedObservations::name() const { return implementation_->pattern->name(); }
std::size_t StreamedObservations::reading_count() const { return implementation_->shards->count(); }
int StreamedObservations::rows() const { return implementation_->pattern->rows(); }
const std::vector<ReadingComponent>& StreamedObservations::components() const {
  return implementation_->pattern->components();
}
const std::vector<SetupUnknown>& StreamedObservations::unknowns() const { return implementation_->pattern->unknowns(); }
std::vector<double> StreamedObservations::unknown_values() const { return implementation_->pattern->unknown_values(); }

std::vector<double> StreamedObservations::positions(std::size_t reading) const {
  return implementation_->part(reading / kStreamedTogether)->positions(reading % kStreamedTogether);
}

std::vector<double> StreamedObservations::deviation(std::size_t reading) const {
  return implementation_->part(reading / kStreamedTogether)->deviation(reading % kStreamedTogether);
}

void StreamedObservations::set_parameters(std::span<const double> machine, std::span<const double> setup) {
  Implementation& own = *implementation_;
  own.pattern->set_parameters(machine, setup);
  own.machine_values.assign(machine.begin(), machine.end());
  own.held.clear();
}

void StreamedObservations::evaluate(std::size_t first, std::size_t count,
                                    std::span<const std::size_t> machine_parameters,
                                    std::span<const std::size_t> setup_parameters, double* residuals, double* jacobian,
                                    std::size_t stride) const {
  const std::size_t begin = first % kStreamedTogether;
  if (begin + count <= kStreamedTogether) {
    implementation_->part(first / kStreamedTogether)
        ->evaluate(begin, count, machine_parameters, setup_parameters, residuals, jacobian, stride);
    return;
  }
  // Over the end of a part, which the sums of an identification never ask for: one reading after the other.
  const std::size_t own_rows = static_cast<std::size_t>(rows());
  const std::size_t columns = jacobian == nullptr ? 0 : machine_parameters.size() + setup_parameters.size();
  std::vector<double> residual(own_rows), derivatives(own_rows * columns);
  for (std::size_t k = 0; k < count; ++k) {
    evaluate(first + k, 1, machine_parameters, setup_parameters, residual.data(),
             jacobian == nullptr ? nullptr : derivatives.data(), own_rows);
    for (std::size_t row = 0; row < own_rows; ++row) {
      residuals[row * count + k] = residual[row];
      for (std::size_t c = 0; c < columns; ++c) {
        jacobian[c * stride + row * count + k] = derivatives[c * own_rows + row];
      }
    }
  }
}

std::optional<FactoredColumns> StreamedObservations::column_factors(
    std::span<const std::size_t> machine_parameters, std::span<const std::size_t> setup_parameters) const {
  return implementation_->pattern->column_factors(machine_parameters, setup_parameters);
}

void StreamedObservations::evaluate_factored(std::size_t first, std::size_t count,
                                             std::span<const std::size_t> machine_parameters,
                                             std::span<const std::size_t> setup_parameters, double* residuals,
                                             const JacobianFactors& factors) const {
  const std::size_t begin = first % kStreamedTogether;
  if (begin + count <= kStreamedTogether) {
    implementation_->part(first / kStreamedTogether)
        ->evaluate_factored(begin, count, machine_parameters, setup_parameters, residuals, factors);
    return;
  }
  // As in evaluate().
  const std::size_t own_rows = static_cast<std::size_t>(rows());
  std::vector<double> residual(own_rows), carriers(own_rows * factors.form.carriers()), bases(factors.form.bases());
  for (std::size_t k = 0; k < count; ++k) {
    evaluate_factored(first + k, 1, machine_parameters, setup_parameters, residual.data(),
                      {factors.form, carriers.data(), own_rows, bases.data(), 1});
    for (std::size_t row = 0; row < own_rows; ++row) {
      residuals[row * count + k] = residual[row];
      for (std::size_t c = 0; c < factors.form.carriers(); ++c) {
        factors.carriers[c * factors.stride + row * count + k] = carriers[c * own_rows + row];
      }
    }
    for (std::size_t b = 0; b < bases.size(); ++b) factors.bases[b * factors.basis_stride + k] = bases[b];
  }
}

}  // namespace abbe
