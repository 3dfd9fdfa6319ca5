#include "abbe/identify/trust/sample_moments.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace abbe {
namespace {

using Index = Eigen::Index;

constexpr Index kBlockSamples = 16384;
constexpr Index kChunkSamples = 256;  // stay in the cache of a processor

/// Of one block, in one matrix: the mean in the first column, then the sums of products of the deviations from it, of
/// which the lower triangle counts.
Eigen::MatrixXd moments_of_block(const Eigen::MatrixXd& samples, Index first, Index count) {
  const Index p = samples.rows();
  Eigen::MatrixXd found = Eigen::MatrixXd::Zero(p, 1 + p);
  found.col(0) = samples.middleCols(first, count).rowwise().mean();
  Eigen::MatrixXd centred(p, std::min(count, kChunkSamples));
  for (Index at = 0; at < count; at += kChunkSamples) {
    auto chunk = centred.leftCols(std::min(kChunkSamples, count - at));
    chunk = samples.middleCols(first + at, chunk.cols()).colwise() - found.col(0);
    found.rightCols(p).selfadjointView<Eigen::Lower>().rankUpdate(chunk);
  }
  return found;
}

}  // namespace

SampleMoments sample_moments(const Eigen::MatrixXd& samples, int threads, const WorkDriver& driver,
                             const std::function<std::uint64_t()>& fingerprint) {
  const Index p = samples.rows(), n = samples.cols();
  std::vector<Eigen::MatrixXd> found(static_cast<std::size_t>((n + kBlockSamples - 1) / kBlockSamples),
                                     Eigen::MatrixXd(p, 1 + p));
  const auto first_of = [](std::size_t block) { return static_cast<Index>(block) * kBlockSamples; };
  const auto count_of = [&](std::size_t block) { return std::min(kBlockSamples, n - first_of(block)); };
  const auto numbers_of = [&](std::size_t block) {
    return std::span<double>(found[block].data(), static_cast<std::size_t>(found[block].size()));
  };
  NumberedWork work{.name = "covariance of the samples", .blocks = found.size(), .threads = threads};
  work.for_all = true;
  work.is_kept = false;
  work.fingerprint = fingerprint;
  work.compute = [&](std::size_t block) { found[block] = moments_of_block(samples, first_of(block), count_of(block)); };
  work.pack = [&](std::size_t block, std::vector<std::byte>& bytes) { pack_numbers(numbers_of(block), bytes); };
  work.unpack = [&](std::size_t block, std::span<const std::byte> bytes) {
    unpack_numbers(bytes, numbers_of(block));
    require_unpacked(bytes);
  };
  do_work(driver, work);
  SampleMoments all{found[0].col(0), found[0].rightCols(p)};
  for (std::size_t block = 1; block < found.size(); ++block) {
    const auto before = static_cast<double>(first_of(block)), added = static_cast<double>(count_of(block));
    const Eigen::VectorXd apart = found[block].col(0) - all.mean;
    all.covariance += found[block].rightCols(p);
    all.covariance.selfadjointView<Eigen::Lower>().rankUpdate(apart, before * added / (before + added));
    all.mean += apart * (added / (before + added));
  }
  all.covariance = Eigen::MatrixXd(all.covariance.selfadjointView<Eigen::Lower>()) / static_cast<double>(n - 1);
  return all;
}

}  // namespace abbe
