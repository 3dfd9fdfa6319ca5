#include "abbe/plan/readings/all_rows.h"

#include <algorithm>
#include <span>
#include <vector>

#include "abbe/geometry/cross_products.h"
#include "abbe/geometry/digest.h"
#include "abbe/geometry/numbered_work.h"
#include "abbe/geometry/parallel_blocks.h"
#include "abbe/plan/readings/padded_columns.h"
#include "abbe/plan/readings/planning_shares.h"

namespace abbe {
namespace {

using Index = Eigen::Index;
// Number of rows. It is fixed because the rounding of sums depends on it.
constexpr Index kBlock = 8192;

Index block_count(Index rows) { return (rows + kBlock - 1) / kBlock; }

/// Factor R of the rows of one block, each column times its scale.
Eigen::MatrixXd factor_of_block(const PlanningCandidates::Rows& rows, Index first, Index end,
                                const Eigen::RowVectorXd& scale) {
  StreamingFactor stream(rows.cols());
  for (Index k = first; k < end; ++k) {
    stream.next() = rows.row(k).cwiseProduct(scale);
    stream.add();
  }
  return stream.factor();
}

/// Adds the products of rows and columns. Zeros are added behind the last row and the last column, up to the next
/// multiple (cross_products.h).
/// @param product  row by row, `stride` apart
void add_products(const Eigen::Ref<const PlanningCandidates::Rows>& rows, const PaddedColumns& columns, int threads,
                  double* product, std::size_t stride) {
  constexpr Index kPart = 256;
  const auto p = static_cast<std::size_t>(rows.cols());
  for_each_block(static_cast<std::size_t>((rows.rows() + kPart - 1) / kPart), threads, [&](std::size_t part) {
    thread_local std::vector<double> aligned;
    const Index first = static_cast<Index>(part) * kPart, count = std::min(kPart, rows.rows() - first);
    aligned.assign(static_cast<std::size_t>(kPart) * columns.length, 0.0);
    for (Index k = 0; k < count; ++k)
      std::copy_n(rows.row(first + k).data(), p, &aligned[static_cast<std::size_t>(k) * columns.length]);
    add_cross_products(columns.numbers.data(), columns.count, columns.length, aligned.data(),
                       padded(static_cast<std::size_t>(count), kColumnMultiple), columns.length, columns.length,
                       product + static_cast<std::size_t>(first) * stride, stride);
  });
}

}  // namespace

Eigen::VectorXd squares_of_columns(const PlanningCandidates::Rows& rows, int threads) {
  const Index blocks = block_count(rows.rows());
  std::vector<Eigen::RowVectorXd> squares(static_cast<std::size_t>(blocks));
  for_each_block(squares.size(), threads, [&](std::size_t block) {
    const Index first = static_cast<Index>(block) * kBlock;
    squares[block] = rows.middleRows(first, std::min(kBlock, rows.rows() - first)).colwise().squaredNorm();
  });
  Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(rows.cols());
  for (const Eigen::RowVectorXd& block : squares) sum += block;
  return sum.transpose();
}

Eigen::MatrixXd factor_of_rows(const PlanningCandidates::Rows& rows, const Eigen::MatrixXd& known,
                               const Eigen::VectorXd& scale, const SharedRows& shared) {
  const Index p = rows.cols(), all = rows.rows(), blocks = block_count(all);
  StreamingFactor stream(p);
  const auto add = [&stream](const auto& row) {
    stream.next() = row;
    stream.add();
  };
  for (Index k = 0; k < known.rows(); ++k) add(known.row(k).cwiseProduct(scale.transpose()));
  if (blocks < 2) {
    for (Index k = 0; k < all; ++k) add(rows.row(k).cwiseProduct(scale.transpose()));
    return stream.factor();
  }
  Digest digest;
  if (shared.in_step.processes > 1) {
    digest.add_text(vector_instructions());
    digest.add(static_cast<std::uint64_t>(all));
    digest.add_numbers({scale.data(), static_cast<std::size_t>(scale.size())});
  }
  const PlanShares shares(shared.in_step, digest.value(), static_cast<std::size_t>(blocks));
  // The upper triangle of each block, column by column.
  const auto triangle = static_cast<std::size_t>(p * (p + 1) / 2);
  std::vector<double> factors(static_cast<std::size_t>(blocks) * triangle);
  const auto of_block = [&](std::size_t block) { return std::span(&factors[block * triangle], triangle); };
  for_each_block(shares.own_count(), shared.threads, [&](std::size_t k) {
    const std::size_t block = shares.own(k);
    const Index first = static_cast<Index>(block) * kBlock;
    const Eigen::MatrixXd factor = factor_of_block(rows, first, std::min(all, first + kBlock), scale.transpose());
    double* to = of_block(block).data();
    for (Index j = 0; j < p; ++j) to = std::copy_n(factor.col(j).data(), j + 1, to);
  });
  std::vector<PlanShares::Piece> pieces;
  for (std::size_t block = 0; block < static_cast<std::size_t>(blocks); ++block)
    pieces.push_back({shares.owner(block), of_block(block)});
  shares.complete(pieces);
  Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(p, p);
  for (std::size_t block = 0; block < static_cast<std::size_t>(blocks); ++block) {
    const double* from = of_block(block).data();
    for (Index j = 0; j < p; from += ++j) std::copy_n(from, j + 1, factor.col(j).data());
    for (Index k = 0; k < p; ++k) add(factor.row(k));
  }
  return stream.factor();
}

std::vector<double> multiply_rows(const PlanningCandidates::Rows& rows, const Eigen::MatrixXd& factor,
                                  const SharedRows& shared, std::size_t stride) {
  constexpr Index kMostRows = Index{1} << 16;
  constexpr double kWorthSharing = 1e7;  // sums of products
  const PaddedColumns columns(factor);
  const std::size_t used = columns.count;  // numbers of each row that are not padding of the stride
  const auto all_rows = static_cast<std::size_t>(rows.rows());
  std::vector<double> product((all_rows + kColumnMultiple) * stride);
  if (rows.cols() == 0 || factor.cols() == 0) return product;
  const WorkInStep& in_step = shared.in_step;
  const auto processes = static_cast<Index>(in_step.processes);
  if (processes == 1 || static_cast<double>(all_rows * used) * static_cast<double>(rows.cols()) < kWorthSharing) {
    add_products(rows, columns, shared.threads, product.data(), stride);
    return product;
  }
  Digest digest;
  digest.add_text(vector_instructions());
  digest.add(static_cast<std::uint64_t>(rows.rows()));
  digest.add_numbers({factor.data(), static_cast<std::size_t>(factor.size())});
  const Index each = std::min(kMostRows, rows.rows() / processes + 1);
  std::vector<double> own;
  for (Index start = 0; start < rows.rows(); start += processes * each) {
    const auto first = [&](Index process) { return std::min(rows.rows(), start + process * each); };
    const auto rank = static_cast<Index>(in_step.rank);
    const auto count = static_cast<std::size_t>(first(rank + 1) - first(rank));
    own.assign((count + kColumnMultiple) * used, 0.0);
    add_products(rows.middleRows(first(rank), static_cast<Index>(count)), columns, shared.threads, own.data(), used);
    const GatheredBytes all = gather(in_step, digest.value(), std::as_bytes(std::span(own).first(count * used)));
    for (Index process = 0; process < processes; ++process) {
      std::span<const std::byte> bytes = all.parts[static_cast<std::size_t>(process)];
      for (Index row = first(process); row < first(process + 1); ++row)
        unpack_numbers(bytes, {&product[static_cast<std::size_t>(row) * stride], used});
      require_unpacked(bytes);
    }
  }
  return product;
}

}  // namespace abbe
