#include "abbe/geometry/registration/shared_fits.h"

#include <array>

#include "abbe/geometry/cross_products.h"
#include "abbe/geometry/digest.h"

namespace abbe {
namespace {

/// Calls with the numbers of which a fit consists, in place, but its undetermined motions.
template <typename Take>
void for_numbers_of_fit(FineRegistration& fit, const Take& take) {
  std::array<double, 4> counts{static_cast<double>(fit.status), static_cast<double>(fit.iterations),
                               static_cast<double>(fit.used), static_cast<double>(fit.beyond_border)};
  take(counts);
  fit.status = static_cast<FineRegistrationStatus>(static_cast<int>(counts[0]));
  fit.iterations = static_cast<int>(counts[1]);
  fit.used = static_cast<Eigen::Index>(counts[2]);
  fit.beyond_border = static_cast<Eigen::Index>(counts[3]);
  take(std::span(fit.mesh_from_scan.rotation.data(), 9));
  take(std::span(fit.mesh_from_scan.translation.data(), 3));
  for (double* const number : {&fit.scale_mm, &fit.rms_mm, &fit.weight_sum}) take(std::span(number, 1));
  take(std::span(fit.covariance.data(), 36));
  take(std::span(fit.reference.data(), 3));
}

template <typename Take>
void for_numbers_of_motion(UndeterminedMotion& motion, const Take& take) {
  std::array<double, 2> rest{motion.rotation ? 1.0 : 0.0, motion.pitch_mm};
  take(rest);
  motion.rotation = rest[0] != 0;
  motion.pitch_mm = rest[1];
  take(std::span(motion.direction.data(), 3));
  take(std::span(motion.point.data(), 3));
}

void pack_fit(FineRegistration& fit, std::vector<std::byte>& bytes) {
  const auto take = [&](std::span<const double> numbers) { pack_numbers(numbers, bytes); };
  for_numbers_of_fit(fit, take);
  const auto motions = static_cast<double>(fit.undetermined.size());
  pack_numbers({&motions, 1}, bytes);
  for (UndeterminedMotion& motion : fit.undetermined) for_numbers_of_motion(motion, take);
}

void unpack_fit(std::span<const std::byte> bytes, FineRegistration& fit) {
  const auto take = [&](std::span<double> numbers) { unpack_numbers(bytes, numbers); };
  for_numbers_of_fit(fit, take);
  double motions = 0;
  unpack_numbers(bytes, {&motions, 1});
  if (!(motions >= 0 && motions <= 6)) throw WorkError("a fit has more motions than there are");
  fit.undetermined.resize(static_cast<std::size_t>(motions));
  for (UndeterminedMotion& motion : fit.undetermined) for_numbers_of_motion(motion, take);
  require_unpacked(bytes);
}

std::uint64_t fingerprint_of_fits(const Eigen::Matrix3Xd& points, std::span<const FitStart> starts,
                                  const FineRegistrationOptions& options) {
  Digest digest;
  digest.add_text("fits from each start");
  digest.add_text(vector_instructions());
  digest.add_numbers({points.data(), static_cast<std::size_t>(points.size())});
  for (const FitStart& start : starts) {
    digest.add_numbers({start.mesh_from_scan.rotation.data(), 9});
    digest.add_numbers({start.mesh_from_scan.translation.data(), 3});
    digest.add_number(start.largest_scale_mm);
  }
  digest.add(static_cast<std::uint64_t>(options.loss) * 2 + (options.adaptive_distance ? 1 : 0));
  digest.add_number(options.noise_mm);
  digest.add_number(options.movement_mm);
  digest.add(static_cast<std::uint64_t>(options.iterations));
  return digest.value();
}

}  // namespace

std::vector<FineRegistration> register_from_each(const Eigen::Matrix3Xd& points, const ClosestPointFinder& surface,
                                                 const SmoothSurface& smooth, std::span<const FitStart> starts,
                                                 const FineRegistrationOptions& options) {
  std::vector<FineRegistration> fits(starts.size());
  NumberedWork work{.name = "search for the start", .blocks = starts.size(), .threads = options.threads};
  work.for_all = true;
  work.is_kept = false;
  work.fingerprint = [&] { return fingerprint_of_fits(points, starts, options); };
  work.compute = [&](std::size_t i) {
    FineRegistrationOptions own = options;
    own.largest_scale_mm = starts[i].largest_scale_mm;
    own.threads = 1;
    own.work = {};
    fits[i] = register_finely(points, surface, smooth, starts[i].mesh_from_scan, own);
  };
  work.pack = [&](std::size_t i, std::vector<std::byte>& bytes) { pack_fit(fits[i], bytes); };
  work.unpack = [&](std::size_t i, std::span<const std::byte> bytes) { unpack_fit(bytes, fits[i]); };
  do_work(options.work, work);
  return fits;
}

}  // namespace abbe
