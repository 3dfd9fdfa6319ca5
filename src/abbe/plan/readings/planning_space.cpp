#include "abbe/plan/readings/planning_space.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>

#include "abbe/geometry/column_norms.h"
#include "abbe/geometry/cross_products.h"
#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/digest.h"
#include "abbe/geometry/numbered_work.h"
#include "abbe/geometry/singular_values.h"
#include "abbe/plan/readings/planning_shares.h"

namespace abbe {
namespace {

using Index = Eigen::Index;
constexpr double kDetermined = 1e-10;
constexpr double kWeakestRounding = 1e-14;
constexpr Index kRowsBetweenReductions = 512;

/// Factor R of rows that come in pieces; the rows themselves are not kept.
class StreamingFactor {
 public:
  explicit StreamingFactor(Index columns) : columns_(columns), work_(columns + kRowsBetweenReductions, columns) {
    work_.setZero();
  }
  /// The row to be written next; valid until add().
  auto next() { return work_.row(columns_ + filled_); }
  void add() {
    if (++filled_ == kRowsBetweenReductions) reduce();
  }
  Eigen::MatrixXd factor() {
    reduce();
    return work_.topRows(columns_);
  }

 private:
  void reduce() {
    if (filled_ == 0) return;
    Qr::in_place(work_);
    for (Index j = 0; j < columns_; ++j) work_.col(j).tail(work_.rows() - j - 1).setZero();
    filled_ = 0;
  }

  Index columns_;
  Index filled_ = 0;
  Eigen::MatrixXd work_;
};

void validate(const PlanningCandidates& candidates, const Eigen::MatrixXd& known) {
  const auto fail = [](const char* what) { throw std::invalid_argument(what); };
  if (candidates.count() == 0) fail("planning: no candidates");
  if (candidates.first_row.front() != 0 ||
      candidates.first_row.back() != static_cast<std::size_t>(candidates.rows.rows()))
    fail("planning: rows of the candidates do not add up");
  for (std::size_t i = 0; i < candidates.count(); ++i) {
    if (candidates.first_row[i + 1] <= candidates.first_row[i] ||
        candidates.first_row[i + 1] - candidates.first_row[i] > PlanningCandidates::kMostRows)
      fail("planning: a candidate needs 1 to 16 rows");
  }
  if (!candidates.cost_s.empty() && candidates.cost_s.size() != candidates.count())
    fail("planning: costs are not one per candidate");
  for (const double cost : candidates.cost_s)
    if (!(cost > 0) || !std::isfinite(cost)) fail("planning: a cost is not above zero");
  if (known.rows() > 0 && known.cols() != candidates.rows.cols()) fail("planning: known rows have another length");
  if (!candidates.rows.allFinite() || !known.allFinite()) fail("planning: a derivative is not finite");
}

using SeenRows = Eigen::Map<PlanningCandidates::Rows, 0, Eigen::OuterStride<>>;

/// The product of all rows, of which each process computes some. These begin at multiples of four rows, which the
/// product takes together, so that the sums are rounded as if one process had computed all.
void multiply_rows(const PlanningCandidates::Rows& rows, const Eigen::MatrixXd& factor, const WorkInStep& in_step,
                   SeenRows product) {
  constexpr Index kTogether = 4, kFew = 64, kMostRows = Index{1} << 16;
  constexpr double kWorthSharing = 1e7;  // sums of products
  const auto processes = static_cast<Index>(in_step.processes);
  if (processes == 1 || static_cast<double>(product.size()) * static_cast<double>(rows.cols()) < kWorthSharing) {
    product.noalias() = rows * factor;
    return;
  }
  Digest digest;
  digest.add_text(vector_instructions());
  digest.add(static_cast<std::uint64_t>(rows.rows()));
  digest.add_numbers({factor.data(), static_cast<std::size_t>(factor.size())});
  const Index each = std::min(kMostRows, (rows.rows() / processes / kTogether + 1) * kTogether);
  PlanningCandidates::Rows own;
  for (Index start = 0; start < rows.rows(); start += processes * each) {
    const auto first = [&](Index process) { return std::min(rows.rows(), start + process * each); };
    const auto rank = static_cast<Index>(in_step.rank);
    // Few rows would be multiplied in another way: those before them are computed too.
    const Index before = first(rank + 1) - first(rank) < kFew ? std::min(first(rank), kFew) : 0;
    own.noalias() = rows.middleRows(first(rank) - before, first(rank + 1) - first(rank) + before) * factor;
    const auto left_out = static_cast<std::size_t>(before * own.cols());
    const std::span<const double> numbers(own.data() + left_out, static_cast<std::size_t>(own.size()) - left_out);
    const GatheredBytes all = gather(in_step, digest.value(), std::as_bytes(numbers));
    for (Index process = 0; process < processes; ++process) {
      std::span<const std::byte> bytes = all.parts[static_cast<std::size_t>(process)];
      for (Index row = first(process); row < first(process + 1); ++row)
        unpack_numbers(bytes, {&product(row, 0), static_cast<std::size_t>(product.cols())});
      require_unpacked(bytes);
    }
  }
}

void add_known(const PlanningSpace& space, StreamingFactor& stream) {
  for (Index k = 0; k < space.known_rows().rows(); ++k) {
    stream.next() = space.known_rows().row(k);
    stream.add();
  }
}

/// Singular value decomposition of the rows of a choice in seen coordinates, what is known included.
RightSingular decompose(const PlanningSpace& space, std::span<const std::size_t> chosen) {
  const Index v = static_cast<Index>(space.dimension());
  StreamingFactor stream(v);
  add_known(space, stream);
  for (const std::size_t candidate : chosen)
    for (std::size_t k = 0; k < space.row_count(candidate); ++k) {
      stream.next() = Eigen::Map<const Eigen::RowVectorXd>(space.row(space.first_row(candidate) + k), v);
      stream.add();
    }
  return right_singular(stream.factor());
}

std::size_t rank_of(const PlanningSpace& space, const Eigen::VectorXd& singular) {
  const double smallest = singular.size() > 0 ? space.determined() * singular[0] : 0;
  return static_cast<std::size_t>((singular.array() > smallest).count());
}

PlanValue value_of(const PlanningSpace& space, const RightSingular& svd, const Eigen::MatrixXd& functionals) {
  PlanValue value;
  value.rank = rank_of(space, svd.values);
  value.determined = value.rank == space.dimension();
  if (!value.determined) return value;
  value.log_determinant = 2 * svd.values.array().log().sum();
  if (functionals.rows() > 0)
    value.variance =
        (space.functionals(functionals) * svd.vectors * svd.values.cwiseInverse().asDiagonal()).squaredNorm();
  return value;
}

}  // namespace

PlanningSpace::PlanningSpace(const PlanningCandidates& candidates, const Eigen::MatrixXd& known,
                             const WorkInStep& in_step, double threshold)
    : first_row_(candidates.first_row), cost_s_(candidates.cost_s) {
  validate(candidates, known);
  const Index p = candidates.rows.cols(), all = candidates.rows.rows();
  column_norms_ = candidates.rows.colwise().squaredNorm().transpose();
  if (known.rows() > 0) column_norms_ += known.colwise().squaredNorm().transpose();
  column_norms_ = column_norms_.cwiseSqrt().eval();
  drop_rounding_columns(column_norms_);
  const Eigen::VectorXd inverse = column_norms_.unaryExpr([](double norm) { return norm > 0 ? 1 / norm : 0.0; });

  StreamingFactor stream(p);
  const auto add = [&](const auto& row) {
    stream.next() = row.cwiseProduct(inverse.transpose());
    stream.add();
  };
  for (Index k = 0; k < known.rows(); ++k) add(known.row(k));
  for (Index k = 0; k < all; ++k) add(candidates.rows.row(k));
  const RightSingular svd = right_singular(stream.factor());
  const double largest = p > 0 ? std::max(svd.values[0], 1e-300) : 1;
  singular_values_ = svd.values / largest;
  Index v = p;
  while (v > 0 && !(singular_values_[v - 1] > threshold)) --v;
  determined_ = std::max(kDetermined, v > 0 ? kWeakestRounding / singular_values_[v - 1] : 0.0);
  estimates_from_seen_ =
      inverse.asDiagonal() * svd.vectors.leftCols(v) * (singular_values_.head(v) * largest).cwiseInverse().asDiagonal();
  // Parameters without any influence have no scale; their direction is the parameter itself.
  unseen_ = inverse.unaryExpr([](double scale) { return scale > 0 ? scale : 1.0; }).asDiagonal() *
            svd.vectors.rightCols(p - v);

  known_rows_ = known.rows() > 0 ? Eigen::MatrixXd(known * estimates_from_seen_) : Eigen::MatrixXd(0, v);
  known_information_ = known_rows_.transpose() * known_rows_;
  // Padded as cross_products.h wants it: length to 8, rows to 4.
  stride_ = (static_cast<std::size_t>(v) + 7) / 8 * 8;
  rows_.assign((static_cast<std::size_t>(all) + 4) * stride_, 0.0);
  multiply_rows(candidates.rows, estimates_from_seen_, in_step,
                {rows_.data(), all, v, Eigen::OuterStride<>(static_cast<Index>(stride_))});
}

Eigen::MatrixXd PlanningSpace::functionals(const Eigen::MatrixXd& rows) const { return rows * estimates_from_seen_; }

Eigen::VectorXd PlanningSpace::unseen_part(const Eigen::MatrixXd& rows) const {
  const Eigen::VectorXd inverse = column_norms_.unaryExpr([](double norm) { return norm > 0 ? 1 / norm : 1.0; });
  const Eigen::VectorXd whole = (rows * inverse.asDiagonal()).rowwise().norm();
  const Eigen::VectorXd part = (rows * unseen_).rowwise().norm();
  return part.binaryExpr(whole, [](double a, double b) { return b > 0 ? a / b : 0.0; });
}

PlanValue value_of(const PlanningSpace& space, std::span<const std::size_t> chosen,
                   const Eigen::MatrixXd& functionals) {
  PlanValue value = value_of(space, decompose(space, chosen), functionals);
  for (const std::size_t candidate : chosen) value.cost += space.cost(candidate);
  return value;
}

PlanValue value_of(const PlanningSpace& space, const PlanningCandidates& others, const Eigen::MatrixXd& functionals) {
  if (others.rows.rows() > 0) validate(others, Eigen::MatrixXd());
  StreamingFactor stream(static_cast<Index>(space.dimension()));
  add_known(space, stream);
  for (Index k = 0; k < others.rows.rows(); ++k) {
    stream.next().noalias() = others.rows.row(k) * space.estimates_from_seen();
    stream.add();
  }
  PlanValue value = value_of(space, right_singular(stream.factor()), functionals);
  for (std::size_t i = 0; i < others.count(); ++i) value.cost += others.cost(i);
  return value;
}

Eigen::MatrixXd planned_covariance(const PlanningSpace& space, std::span<const std::size_t> chosen) {
  const RightSingular svd = decompose(space, chosen);
  if (rank_of(space, svd.values) != space.dimension()) return {};
  const Eigen::MatrixXd root = space.estimates_from_seen() * svd.vectors * svd.values.cwiseInverse().asDiagonal();
  return root * root.transpose();
}

}  // namespace abbe
