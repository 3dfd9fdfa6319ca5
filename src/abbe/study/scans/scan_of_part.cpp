#include "abbe/study/scans/scan_of_part.h"

#include "abbe/formats/text/input_error.h"

namespace abbe {

void check_scan_and_part(const PointCloudFile& scan, const std::string& scan_file, const MeshFile& part,
                         const std::string& part_file) {
  if (scan.cloud.size() == 0) throw InputError({.file = scan_file}, "there is no point", "the points of a scan");
  if (part.mesh.size() == 0) throw InputError({.file = part_file}, "there is no triangle", "the surface of a part");
}

PointCloud moved_cloud(const PointCloud& cloud, const RigidTransform& motion) {
  PointCloud result;
  result.points = (motion.rotation * cloud.points).colwise() + motion.translation;
  if (cloud.has_normals()) result.normals = motion.rotation * cloud.normals;
  return result;
}

}  // namespace abbe
