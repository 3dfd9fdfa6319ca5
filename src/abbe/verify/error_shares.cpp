#include <algorithm>
#include <stdexcept>

#include "abbe/geometry/parallel_blocks.h"
#include "abbe/verify/error_map.h"
#include "abbe/verify/parts/deviation_block.h"

namespace abbe {
namespace {

struct Group {
  std::string name;
  ErrorSet errors;
};

struct GroupSums {
  double norm = 0, maximum = 0, product = 0;
};

std::vector<ErrorShare> shares(const Machine& machine, const ErrorSet& all, const std::vector<Group>& groups,
                               const PoseSource& poses, int threads) {
  if (poses.axes != machine.axes.size()) throw std::invalid_argument("shares: poses do not fit the machine's axes");
  const DeviationModel whole(machine, all, nullptr, false);
  std::vector<DeviationModel> parts;
  for (const Group& group : groups) parts.emplace_back(machine, group.errors, nullptr, false);
  const std::size_t blocks = block_count(poses);
  std::vector<std::vector<GroupSums>> sums(blocks, std::vector<GroupSums>(groups.size()));
  std::vector<double> squares(blocks, 0.0), counts(blocks, 0.0);
  for_each_block(blocks, threads, [&](std::size_t index) {
    DeviationBlock total, part;
    load_block(poses, index, total);
    load_block(poses, index, part);
    whole.evaluate(total, {});
    for (std::size_t k = 0; k < total.count; ++k) {
      if (!total.covered[k]) continue;
      squares[index] += total.norm[k] * total.norm[k];
      counts[index] += 1;
    }
    for (std::size_t g = 0; g < groups.size(); ++g) {
      parts[g].evaluate(part, {});
      GroupSums& own = sums[index][g];
      for (std::size_t k = 0; k < total.count; ++k) {
        if (!total.covered[k]) continue;
        own.norm += part.norm[k];
        own.maximum = std::max(own.maximum, part.norm[k]);
        for (std::size_t c = 0; c < 3; ++c) own.product += part.displacement[c][k] * total.displacement[c][k];
      }
    }
  });
  double square = 0, count = 0;
  for (std::size_t i = 0; i < blocks; ++i) {
    square += squares[i];
    count += counts[i];
  }
  std::vector<ErrorShare> result;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    ErrorShare share{.name = groups[g].name, .mean = 0, .maximum = 0, .share = 0};
    for (std::size_t i = 0; i < blocks; ++i) {
      share.mean += sums[i][g].norm;
      share.share += sums[i][g].product;
      share.maximum = std::max(share.maximum, sums[i][g].maximum);
    }
    share.mean = count > 0 ? share.mean / count : 0;
    share.share = square > 0 ? share.share / square : 0;
    result.push_back(share);
  }
  return result;
}

}  // namespace

std::vector<ErrorShare> shares_by_kind(const Machine& machine, const ErrorSet& errors, const PoseSource& poses,
                                       int threads) {
  std::vector<Group> groups(4);
  groups[0].name = "translations";
  groups[1].name = "rotations";
  groups[2].name = "locations";
  groups[3].name = "tool";
  for (Group& group : groups) group.errors.composition = errors.composition;
  for (const ErrorMotion& motion : errors.motions) {
    groups[is_rotation(motion.component) ? 1 : 0].errors.motions.push_back(motion);
  }
  groups[2].errors.locations = errors.locations;
  groups[3].errors.tool_offset_error = errors.tool_offset_error;
  return shares(machine, errors, groups, poses, threads);
}

std::vector<ErrorShare> shares_by_axis(const Machine& machine, const ErrorSet& errors, const PoseSource& poses,
                                       int threads) {
  std::vector<Group> groups;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    Group group{machine.axes[i].name, {}};
    group.errors.composition = errors.composition;
    for (const ErrorMotion& motion : errors.motions) {
      if (motion.axis == i) group.errors.motions.push_back(motion);
    }
    for (const LocationError& location : errors.locations) {
      if (location.axis == i) group.errors.locations.push_back(location);
    }
    groups.push_back(std::move(group));
  }
  return shares(machine, errors, groups, poses, threads);
}

}  // namespace abbe
