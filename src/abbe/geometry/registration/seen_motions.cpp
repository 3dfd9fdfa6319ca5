#include "abbe/geometry/registration/seen_motions.h"

#include "abbe/geometry/decompositions.h"
#include "abbe/geometry/parallel_blocks.h"
#include "abbe/geometry/registration/registration_pass.h"

namespace abbe {
namespace {

/// Share of the information of the best seen motion below which a motion counts as not seen.
constexpr double kUnseen = 1e-5;
constexpr std::size_t kNumbers = 7;  ///< of a row

}  // namespace

void do_motion_pass(const MotionPass& pass, const WorkDriver& driver, int threads) {
  if (!driver || pass.points < kLeastSharedPoints) return for_each_block(pass.rows.size(), threads, pass.compute);
  NumberedWork work{.name = "seen motions", .blocks = pass.rows.size(), .threads = threads};
  work.for_all = true;
  work.is_kept = false;
  work.in_ranges = true;
  work.fingerprint = pass.fingerprint;
  work.compute = pass.compute;
  work.pack = [&](std::size_t block, std::vector<std::byte>& bytes) {
    for (const MotionRow& row : pass.rows[block]) {
      pack_numbers({&row.weight, 1}, bytes);
      pack_numbers({row.gradient.data(), 6}, bytes);
    }
  };
  work.unpack = [&](std::size_t block, std::span<const std::byte> bytes) {
    pass.rows[block].resize(bytes.size() / (kNumbers * sizeof(double)));
    for (MotionRow& row : pass.rows[block]) {
      unpack_numbers(bytes, {&row.weight, 1});
      unpack_numbers(bytes, {row.gradient.data(), 6});
    }
    require_unpacked(bytes);
  };
  do_work(driver, work);
}

SeenMotions seen_motions_of(std::span<const std::vector<MotionRow>> rows) {
  Matrix6d information = Matrix6d::Zero();
  // In the order of the points, so that the sum does not depend on the threads.
  for (const std::vector<MotionRow>& block : rows) {
    for (const MotionRow& row : block) information += row.weight * row.gradient * row.gradient.transpose();
  }
  const SymmetricEigen<6> solver(information);
  Eigen::Index unseen = 0;
  while (unseen < 6 && !(solver.eigenvalues()[unseen] > kUnseen * solver.eigenvalues()[5])) ++unseen;
  return {solver.eigenvectors().rightCols(6 - unseen), solver.eigenvectors().leftCols(unseen)};
}

}  // namespace abbe
