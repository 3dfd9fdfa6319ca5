#include "yin/study.h"

#include <algorithm>
#include <cmath>

#include "yin/constants.h"

namespace abbe {
namespace {

double difference(const RigidTransform& a, const RigidTransform& b) {
  return std::max((a.translation - b.translation).norm(), 1000 * (a.rotation - b.rotation).norm());
}

}  // namespace

YinSteps yin_steps(LinkageConvention convention) {
  const YinLinkageReference reference = yin_linkage_reference(convention);
  YinSteps steps;
  steps.found = evaluate_linkage(reference.readings, LinkageAccuracy::published());
  for (std::size_t i = 0; i < SwingHeadLinkage::kCount; ++i) {
    for (const double off : {steps.found.linkage.values()[i] - reference.recovered[i],
                             steps.found.printed.values()[i] - reference.printed[i]}) {
      // Of what is no number too: no comparison with it is true.
      if (!(std::abs(off) <= steps.largest_difference)) steps.largest_difference = std::abs(off);
    }
  }
  return steps;
}

void place_workpiece(YinPositioning& p) {
  p.failure.clear();
  if (p.scanner.status != PositioningStatus::ok) {
    p.failure = "the scanner's position is not found: " + p.scanner.reason;
  } else if (p.registration.status != FineRegistrationStatus::ok) {
    p.failure =
        std::string("the workpiece's position is not found: ") + registration_status_name(p.registration.status);
  }
  if (!p.failure.empty()) return;
  p.placement = locate_workpiece(p.scanner, p.registration);
  p.table_to_workpiece = positioning_parameters(p.placement, true);
  p.workpiece_to_table = positioning_parameters(p.placement, false);
}

YinPositioning yin_positioning() {
  YinPositioningReference reference = yin_positioning_reference();
  reference.scans.target_noise = yin::kTargetNoise;
  reference.scans.sphere_noise = yin::kSurfaceNoise;
  YinPositioning result;
  result.scanner = locate_scanner(reference.scans);
  FeatureRegistrationOptions options;
  options.noise_mm = yin::kSurfaceNoise;
  result.registration = register_to_features(reference.surface, yin_part(), reference.labels, reference.start, options);
  place_workpiece(result);
  if (!result.failure.empty()) return result;
  for (const double off :
       {difference(result.scanner.table_from_scanner, reference.table_from_scanner),
        difference(result.registration.mesh_from_scan, reference.workpiece_from_scanner),
        difference(result.placement.table_from_workpiece.inverse(), reference.workpiece_from_table)}) {
    if (!(off <= result.largest_difference)) result.largest_difference = off;
  }
  return result;
}

}  // namespace abbe
