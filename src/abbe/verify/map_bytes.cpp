#include "abbe/verify/map_bytes.h"

#include "abbe/errors/error_digest.h"
#include "abbe/geometry/cross_products.h"
#include "abbe/verify/parts/deviation_block.h"

namespace abbe {
namespace {

/// The arrays of a map that are not empty.
std::vector<std::vector<double>*> arrays_of(ErrorMap& map) {
  std::vector<std::vector<double>*> arrays;
  const auto add = [&](std::vector<double>& array) {
    if (!array.empty()) arrays.push_back(&array);
  };
  for (auto* const three : {&map.point, &map.displacement, &map.rotation}) {
    for (std::vector<double>& array : *three) add(array);
  }
  for (std::vector<double>& array : map.uncertainty) add(array);
  add(map.norm_uncertainty);
  return arrays;
}

}  // namespace

std::uint64_t map_fingerprint(const Machine& machine, const ErrorSet& actual, const ErrorSet* reference,
                              const PoseSource& poses, const ErrorMapOptions& options) {
  Digest digest;
  digest.add_text("map");
  digest.add_text(vector_instructions());
  add_to(digest, machine);
  add_to(digest, actual);
  digest.add(reference != nullptr ? 1 : 0);
  if (reference != nullptr) add_to(digest, *reference);
  digest.add(options.orientation ? 1 : 0);
  digest.add(options.remove_rigid_motion ? 1 : 0);
  if (options.covariance != nullptr) {
    const Eigen::MatrixXd& covariance = options.covariance->covariance;
    for (const std::size_t parameter : options.covariance->parameters) digest.add(parameter);
    digest.add_numbers({covariance.data(), static_cast<std::size_t>(covariance.size())});
  }
  DeviationBlock block;
  for (std::size_t index = 0; index < block_count(poses); ++index) {
    load_block(poses, index, block);
    for (const double* const axis : block.axis) digest.add_numbers({axis, block.count});
    for (const double* const state : block.state) digest.add_numbers({state, block.count});
  }
  return digest.value();
}

MapBytes bytes_of(ErrorMap& map) {
  MapBytes bytes;
  bytes.pack = [arrays = arrays_of(map)](std::size_t first, std::size_t count, std::vector<std::byte>& to) {
    for (const std::vector<double>* const array : arrays) pack_numbers({array->data() + first, count}, to);
  };
  bytes.map = &map;
  bytes.unpack = [arrays = arrays_of(map)](std::size_t first, std::size_t count, std::span<const std::byte>& from) {
    for (std::vector<double>* const array : arrays) unpack_numbers(from, {array->data() + first, count});
  };
  return bytes;
}

}  // namespace abbe
