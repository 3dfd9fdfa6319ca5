// The compiled part of Highway that programs need (cmake/AbbeStatic.cmake): which processor this is, and the choice
// that is made by it once. Results do not depend on it, only their speed.
#include <hwy/targets.h>

#include "supported_targets.h"

namespace hwy {

int64_t SupportedTargets() { return abbe::supported_targets(); }

ChosenTarget& GetChosenTarget() {
  static ChosenTarget chosen;
  return chosen;
}

}  // namespace hwy
