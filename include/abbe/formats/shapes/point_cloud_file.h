#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/formats/text/csv_reader.h"
#include "abbe/formats/text/file_unit.h"
#include "abbe/geometry/surface/point_cloud.h"

namespace abbe {

struct PointCloudOptions {
  std::optional<FileLength> unit;  ///< of files that state none; without it mm, which the result says
  ColumnMapping mapping;           ///< of CSV files that Abbe did not write
  int threads = 0;                 ///< 0: all
  bool in_plane = false;           ///< a CSV file need not have z, which is then zero
};

/// A point cloud as read, and what a reader of the result has to know about it.
struct PointCloudFile {
  PointCloud cloud;                  ///< mm
  std::vector<double> deviation_mm;  ///< [n] of a CSV file with a column deviation_mm, or empty
  std::vector<std::string> names;    ///< [n] of a CSV file with a column point, or empty
  std::string format;                ///< "XYZ", "CSV", "PLY, ascii", "PCD, binary", "E57, 3 scans"
  FileUnit unit;
  std::size_t left_out = 0;          ///< points without coordinates (PCD, E57)
  std::vector<std::string> notes{};  ///< such as "2 points are left out: the file marks their coordinates as invalid"
};

/// Reads CSV (.csv: x_mm, y_mm, z_mm, perhaps nx, ny, nz and point), PLY, PCD, E57, OBJ (the vertices) or XYZ: any
/// other file, with three numbers in a line, or six, of which the last three are a unit normal. See
/// docs/geometry-files.md.
///
/// Points keep their order; all of them count or are an error, except points of PCD and E57 files without coordinates,
/// which are left out and counted. Normals become unit vectors. @throws InputError
PointCloudFile read_point_cloud(const std::filesystem::path& path, const PointCloudOptions& options = {});

/// The same from the contents. @param file  name for messages; its extension counts
PointCloudFile parse_point_cloud(std::string_view contents, const std::string& file,
                                 const PointCloudOptions& options = {});

/// True for the extensions of point clouds that are no meshes (.xyz .asc .pts .csv .pcd .e57, also in capitals).
bool has_point_cloud_extension(const std::filesystem::path& path);

/// What is to be said of a file: "PCD, binary, m (as given); 2 points are left out: ...".
std::string cloud_words(const PointCloudFile& file);

/// CSV of points in mm: x_mm,y_mm,z_mm, then nx,ny,nz, deviation_mm and point where there are any; reads back to the
/// same bits.
/// @param deviation_mm  [n] or empty
/// @param names         [n] or empty
std::string point_cloud_csv(const PointCloud& cloud, const std::vector<double>& deviation_mm = {},
                            const std::vector<std::string>& names = {});

}  // namespace abbe
