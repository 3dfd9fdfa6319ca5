#include "abbe/verify/uncertainty_budget.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "abbe/errors/random_stream.h"

namespace abbe {
namespace {

/// Mean square over the points of each kind, [kinds].
Eigen::VectorXd mean_squares(const Eigen::MatrixXd& result) { return result.rowwise().squaredNorm() / result.cols(); }

/// Mean squares of many runs with their scatter.
class Drawn {
 public:
  explicit Drawn(Eigen::Index kinds) : sum_(Eigen::VectorXd::Zero(kinds)), squares_(sum_) {}
  void add(const Eigen::VectorXd& mean_square) {
    sum_ += mean_square;
    squares_ += mean_square.cwiseAbs2();
    ++count_;
  }
  void enter(std::vector<BudgetFigure>& kinds) const {
    const auto n = static_cast<double>(count_);
    for (std::size_t k = 0; k < kinds.size() && count_ > 1; ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      const double mean = sum_[i] / n, variance = std::max(0.0, squares_[i] / n - mean * mean) / (n - 1);
      kinds[k].by_monte_carlo = std::sqrt(mean);
      kinds[k].monte_carlo_uncertainty = mean > 0 ? std::sqrt(variance) / (2 * std::sqrt(mean)) : 0;
    }
  }

 private:
  Eigen::VectorXd sum_, squares_;
  std::size_t count_ = 0;
};

}  // namespace

double BudgetFigure::disagreement() const {
  const double difference = std::abs(by_monte_carlo - by_sensitivity);
  if (monte_carlo_uncertainty > 0) return difference / monte_carlo_uncertainty;
  return difference > 0 ? HUGE_VAL : 0;
}

double UncertaintyBudget::largest_disagreement(double negligible) const {
  double largest = 0;
  for (std::size_t k = 0; k < total.size(); ++k) {
    largest = std::max(largest, total[k].disagreement());
    for (const BudgetLine& line : lines) {
      const BudgetFigure& figure = line.kinds[k];
      const bool counts = std::max(figure.by_sensitivity, figure.by_monte_carlo) > negligible * total[k].by_sensitivity;
      if (counts) largest = std::max(largest, figure.disagreement());
    }
  }
  return largest;
}

UncertaintyBudget uncertainty_budget(const BudgetModel& model, const std::vector<BudgetInput>& inputs,
                                     const BudgetOptions& options,
                                     const std::function<void(const Eigen::MatrixXd&)>& each_run) {
  std::vector<double> deviations(inputs.size(), 0.0);
  const Eigen::MatrixXd nominal = model(deviations);
  const auto change = [&] {
    Eigen::MatrixXd result = model(deviations);
    if (result.rows() != nominal.rows() || result.cols() != nominal.cols()) {
      throw std::invalid_argument("the model of an uncertainty budget has results of different shapes");
    }
    result -= nominal;
    return result;
  };
  const auto kinds = static_cast<std::size_t>(nominal.rows());
  UncertaintyBudget budget;
  budget.inputs = inputs.size();
  budget.runs = options.runs;
  budget.runs_per_cause = options.runs_per_cause;
  budget.total.resize(kinds);

  std::map<std::string, std::vector<std::size_t>> causes;
  for (std::size_t i = 0; i < inputs.size(); ++i) causes[inputs[i].cause].push_back(i);
  Eigen::VectorXd all = Eigen::VectorXd::Zero(nominal.rows());
  std::uint64_t stream = 0;
  for (const auto& [cause, members] : causes) {
    BudgetLine line{cause, members.size(), std::vector<BudgetFigure>(kinds), 0};
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(nominal.rows());
    for (const std::size_t i : members) {
      const double u = inputs[i].standard_uncertainty;
      deviations[i] = u;
      Eigen::MatrixXd difference = change();
      deviations[i] = -u;
      difference -= change();
      deviations[i] = 0;
      squares += mean_squares(difference / 2);
    }
    Drawn drawn(nominal.rows());
    RandomStream random(options.seed, ++stream);
    for (std::size_t run = 0; run < options.runs_per_cause; ++run) {
      for (const std::size_t i : members) deviations[i] = inputs[i].standard_uncertainty * random.normal();
      drawn.add(mean_squares(change()));
    }
    for (const std::size_t i : members) deviations[i] = 0;
    for (std::size_t k = 0; k < kinds; ++k) {
      line.kinds[k].by_sensitivity = std::sqrt(squares[static_cast<Eigen::Index>(k)]);
    }
    drawn.enter(line.kinds);
    line.share = squares.sum();
    all += squares;
    budget.lines.push_back(std::move(line));
  }
  for (BudgetLine& line : budget.lines) line.share = all.sum() > 0 ? line.share / all.sum() : 0;
  std::stable_sort(budget.lines.begin(), budget.lines.end(),
                   [](const BudgetLine& a, const BudgetLine& b) { return a.share > b.share; });
  for (std::size_t k = 0; k < kinds; ++k) {
    budget.total[k].by_sensitivity = std::sqrt(all[static_cast<Eigen::Index>(k)]);
  }
  Drawn drawn(nominal.rows());
  RandomStream random(options.seed);
  for (std::size_t run = 0; run < options.runs; ++run) {
    for (std::size_t i = 0; i < inputs.size(); ++i) deviations[i] = inputs[i].standard_uncertainty * random.normal();
    const Eigen::MatrixXd result = change();
    drawn.add(mean_squares(result));
    if (each_run) each_run(result + nominal);
  }
  drawn.enter(budget.total);
  return budget;
}

}  // namespace abbe
