#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "abbe/errors/factored_columns.h"

namespace abbe {

struct ErrorSet;
struct FurtherReadings;
struct Machine;

/// An unknown of a set-up: the pose of an instrument, an offset of a target.
struct SetupUnknown {
  std::string name;             ///< "tracker1.x", "reflector2.offset_z"
  bool is_angle = false;        ///< rad if true, mm if false
  double scale = 1;             ///< typical size, mm or rad: only for scaling and finite steps, never for the result
  bool is_pure_number = false;  ///< neither mm nor rad: a scale
};

/// One number of a reading: "length", "x", "pitch".
struct ReadingComponent {
  std::string name;             ///< as in files: "length" of length_mm
  bool is_angle = false;        ///< rad if true, mm if false
  bool is_pure_number = false;  ///< neither mm nor rad: an element of a quaternion
  bool is_relative = false;  ///< counts from a known number of the reading: 0 where it was measured, no column in files
};

/// Where Observations::evaluate_factored() writes the factors of a Jacobian.
struct JacobianFactors {
  const FactoredColumns& form;
  double* carriers = nullptr;    ///< [form.carriers()] carriers[carrier * stride + row * count + k], per mm or rad
  std::size_t stride = 0;        ///< >= rows() * count
  double* bases = nullptr;       ///< [form.bases()] bases[basis * basis_stride + k], dimensionless or of a state
  std::size_t basis_stride = 0;  ///< >= count
};

/// All readings of one set-up of one instrument, as weighted residuals of the machine's errors and the set-up's
/// unknowns.
///
/// The identification knows instruments only through this. Residual = (measured - modelled) / standard uncertainty,
/// after whitening if a reading's components are correlated, so that every residual has variance 1 if model and noise
/// are right. Readings are numbered in the order of the data; `rows()` residuals belong to each.
class Observations {
 public:
  virtual ~Observations() = default;

  virtual std::string name() const = 0;
  virtual std::size_t reading_count() const = 0;
  virtual int rows() const = 0;
  /// What the components of measured - modelled are, [rows()].
  virtual const std::vector<ReadingComponent>& components() const = 0;

  virtual const std::vector<SetupUnknown>& unknowns() const = 0;
  /// Present values of the unknowns, [unknowns().size()], mm or rad.
  virtual std::vector<double> unknown_values() const = 0;

  /// Axis commands of one reading, chain order, mm or rad: to say where a residual is.
  virtual std::vector<double> positions(std::size_t reading) const = 0;

  /// Measured - modelled of one reading at the present point, not weighted, [rows()], mm or rad as components() say.
  virtual std::vector<double> deviation(std::size_t reading) const = 0;
  /// The same of readings first .. first + count - 1. Thread-safe.
  /// @param count  at most kBlockSize
  /// @param out    out, out[row * count + k]
  virtual void deviations(std::size_t first, std::size_t count, double* out) const;

  /// Sets the point at which evaluate() works. Not thread-safe against evaluate().
  /// @param machine  values of ErrorSet::parameters() of the model the observations were built with
  /// @param setup    values of unknowns()
  virtual void set_parameters(std::span<const double> machine, std::span<const double> setup) = 0;

  /// Largest number of readings per call of evaluate().
  static constexpr std::size_t kBlockSize = 128;

  /// Residuals and, if wanted, the Jacobian of the MODELLED values (so d(residual)/d(parameter) = -jacobian) of
  /// readings first .. first + count - 1. Thread-safe. Does not allocate per reading.
  ///
  /// @param machine_parameters  indices of the machine parameters wanted
  /// @param setup_parameters    indices of the unknowns wanted; their columns follow the machine's
  /// @param residuals  out, residuals[row * count + k]; dimensionless
  /// @param jacobian   null or out, jacobian[column * stride + row * count + k], per mm or rad; stride >= rows() *
  /// count
  virtual void evaluate(std::size_t first, std::size_t count, std::span<const std::size_t> machine_parameters,
                        std::span<const std::size_t> setup_parameters, double* residuals, double* jacobian,
                        std::size_t stride) const = 0;

  /// How the columns of evaluate() are products of two factors each, at every point; none if they are not.
  /// Those of set-up unknowns are the last carriers, in their order.
  virtual std::optional<FactoredColumns> column_factors(std::span<const std::size_t> machine_parameters,
                                                        std::span<const std::size_t> setup_parameters) const;

  /// evaluate() with the factors of the Jacobian in place of the Jacobian. Thread-safe.
  /// @param factors  form: what column_factors() gives for the same parameters, which must not be none
  virtual void evaluate_factored(std::size_t first, std::size_t count, std::span<const std::size_t> machine_parameters,
                                 std::span<const std::size_t> setup_parameters, double* residuals,
                                 const JacobianFactors& factors) const;

  /// Derivatives of the modelled values of readings first .. first + count - 1 by a displacement of what is seen (the
  /// reflector, the body that carries the item), in the frame of the body on which the instrument stands, at the
  /// present point and weighted as residuals are. Thread-safe.
  ///
  /// @param rows_out  out, rows_out[(direction * rows() + row) * count + k], per mm; direction 0..2: along x, y, z
  /// @return false if these observations do not come from such a displacement; rows_out is then left as it is
  virtual bool displacement_rows(std::size_t first, std::size_t count, double* rows_out) const {
    static_cast<void>(first), static_cast<void>(count), static_cast<void>(rows_out);
    return false;
  }

  /// What this set-up could read additionally, easiest first; nothing where there are no readings to start from.
  /// @param errors  those of the model, all zero
  virtual std::vector<FurtherReadings> further_readings(const Machine& machine, const ErrorSet& errors) const;

  /// How far measured and modelled are apart at the present point, mm, not weighted; none where only angles are read.
  virtual std::optional<double> length_of_deviation(std::size_t reading) const;
};

}  // namespace abbe
