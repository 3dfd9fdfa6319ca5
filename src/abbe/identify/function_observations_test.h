#pragma once

#include <cmath>
#include <complex>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "abbe/identify/problem.h"

namespace abbe {

/// Observations of any analytic function of set-up unknowns, differentiated by the complex step (exact to rounding).
class FunctionObservations : public Observations {
 public:
  using Complex = std::complex<double>;
  /// model(reading, row, parameters); data [reading * rows + row]; one standard uncertainty for all.
  using Model = std::function<Complex(std::size_t, std::size_t, const std::vector<Complex>&)>;

  FunctionObservations(std::size_t parameters, int rows, std::vector<double> data, double uncertainty, Model model)
      : rows_(rows), data_(std::move(data)), uncertainty_(uncertainty), model_(std::move(model)), values_(parameters) {
    for (std::size_t i = 0; i < parameters; ++i) unknowns_.push_back({"b" + std::to_string(i + 1), false, 1});
    for (int row = 0; row < rows; ++row) components_.push_back({"y" + std::to_string(row + 1), false});
  }
  std::string name() const override { return "function"; }
  std::size_t reading_count() const override { return data_.size() / static_cast<std::size_t>(rows_); }
  int rows() const override { return rows_; }
  const std::vector<ReadingComponent>& components() const override { return components_; }
  const std::vector<SetupUnknown>& unknowns() const override { return unknowns_; }
  std::vector<double> unknown_values() const override { return values_; }
  std::vector<double> positions(std::size_t reading) const override { return {static_cast<double>(reading)}; }
  std::vector<double> deviation(std::size_t reading) const override {
    const std::vector<Complex> at(values_.begin(), values_.end());
    std::vector<double> result;
    for (std::size_t r = 0; r < components_.size(); ++r) {
      result.push_back(data_[reading * components_.size() + r] - model_(reading, r, at).real());
    }
    return result;
  }
  void set_parameters(std::span<const double>, std::span<const double> setup) override {
    values_.assign(setup.begin(), setup.end());
  }
  void start(std::vector<double> values) { values_ = std::move(values); }
  std::vector<double>& data() { return data_; }

  void evaluate(std::size_t first, std::size_t count, std::span<const std::size_t> machine_parameters,
                std::span<const std::size_t> setup_parameters, double* residuals, double* jacobian,
                std::size_t stride) const override {
    const std::size_t rows = static_cast<std::size_t>(rows_);
    std::vector<Complex> at(values_.begin(), values_.end());
    for (std::size_t k = 0; k < count; ++k)
      for (std::size_t r = 0; r < rows; ++r) {
        residuals[r * count + k] = (data_[(first + k) * rows + r] - model_(first + k, r, at).real()) / uncertainty_;
        if (!jacobian) continue;
        for (std::size_t c = 0; c < machine_parameters.size(); ++c) jacobian[c * stride + r * count + k] = 0;
        for (std::size_t c = 0; c < setup_parameters.size(); ++c) {
          Complex& moved = at[setup_parameters[c]];
          moved += Complex(0, 1e-100);
          jacobian[(machine_parameters.size() + c) * stride + r * count + k] =
              model_(first + k, r, at).imag() / 1e-100 / uncertainty_;
          moved = moved.real();
        }
      }
  }

 private:
  int rows_;
  std::vector<double> data_;
  double uncertainty_;
  Model model_;
  std::vector<double> values_;
  std::vector<SetupUnknown> unknowns_;
  std::vector<ReadingComponent> components_;
};

/// A problem with the function's parameters as only unknowns.
inline Problem function_problem(const std::vector<Observations*>& observations) {
  std::vector<std::shared_ptr<Observations>> shared;
  for (Observations* one : observations) shared.push_back(borrowed(*one));
  Problem problem = estimate_everything({}, {}, shared);
  problem.machine_parameters.clear();
  return problem;
}

}  // namespace abbe
