#pragma once

#include <string>

#include "abbe/formats/shapes/mesh_file.h"
#include "abbe/formats/shapes/point_cloud_file.h"
#include "abbe/geometry/rigid_transform.h"

namespace abbe {

/// @throws InputError for a scan without points and a part without triangles
void check_scan_and_part(const PointCloudFile& scan, const std::string& scan_file, const MeshFile& part,
                         const std::string& part_file);

/// Points of a scan where a motion takes them, with their normals.
PointCloud moved_cloud(const PointCloud& cloud, const RigidTransform& motion);

}  // namespace abbe
