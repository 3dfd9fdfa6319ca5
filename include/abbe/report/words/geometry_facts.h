#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "abbe/formats/shapes/mesh_file.h"
#include "abbe/formats/shapes/point_cloud_file.h"

namespace abbe {

/// Facts about a scan and its part for a report: "scan", "part" with format, unit, counts.
std::vector<std::pair<std::string, std::string>> facts_of(const PointCloudFile& scan, const MeshFile& part);

/// "2 faces are left out (1.3 % of the area): #78 ...; #91 ...". @param mesh  from which some are
std::string left_out_faces_words(const MeshFile& mesh);

/// "incomplete: 2 faces are left out (1.3 % of the area): #78 ...; #91 ..."; empty if none is.
std::string incomplete_words(const MeshFile& mesh);

/// Text of a vector: "(1.25, -3, 0.5)".
std::string triple_text(const Eigen::Vector3d& vector);

}  // namespace abbe
