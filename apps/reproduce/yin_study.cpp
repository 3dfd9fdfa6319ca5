#include "reproduce/yin_study.h"

#include <algorithm>
#include <cmath>

namespace abbe {
namespace {

constexpr double kTargetNoise = 0.010, kSurfaceNoise = 0.020;  // mm

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
      steps.largest_difference = std::max(steps.largest_difference, std::abs(off));
    }
  }
  return steps;
}

YinPositioning yin_positioning() {
  YinPositioningReference reference = yin_positioning_reference();
  reference.scans.target_noise = kTargetNoise;
  reference.scans.sphere_noise = kSurfaceNoise;
  YinPositioning result;
  result.scanner = locate_scanner(reference.scans);
  FeatureRegistrationOptions options;
  options.noise_mm = kSurfaceNoise;
  result.registration = register_to_features(reference.surface, yin_part(), reference.labels, reference.start, options);
  result.placement = locate_workpiece(result.scanner, result.registration);
  result.table_to_workpiece = positioning_parameters(result.placement, true);
  result.workpiece_to_table = positioning_parameters(result.placement, false);
  result.largest_difference =
      std::max({difference(result.scanner.table_from_scanner, reference.table_from_scanner),
                difference(result.registration.mesh_from_scan, reference.workpiece_from_scanner),
                difference(result.placement.table_from_workpiece.inverse(), reference.workpiece_from_table)});
  return result;
}

}  // namespace abbe
