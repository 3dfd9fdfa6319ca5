// Work that the processes do in step (docs/scale.md).
#include <utility>

#include "mpi_group.h"

namespace abbe {

WorkInStep MpiGroup::in_step() {
  return {static_cast<std::size_t>(size_), static_cast<std::size_t>(rank_),
          [this](std::uint64_t fingerprint, std::vector<std::byte> own, const WorkInStep::Merge& merge) {
            if (!is_first()) return give(fingerprint, std::move(own), merge);
            std::vector<std::byte> all = given_by_all(fingerprint, std::move(own), merge);
            send_down(all);
            return all;
          }};
}

}  // namespace abbe
