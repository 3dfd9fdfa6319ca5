#include "abbe/formats/shapes/point_cloud_file.h"

#include <fmt/format.h>

#include <array>
#include <cassert>

#include "abbe/formats/files/file_extension.h"
#include "abbe/formats/files/standard_input.h"
#include "abbe/formats/import/readable_table.h"
#include "abbe/formats/shapes/cloud_columns.h"
#include "abbe/formats/shapes/deviation_rows.h"
#include "abbe/formats/shapes/e57_file.h"
#include "abbe/formats/shapes/ending.h"
#include "abbe/formats/shapes/obj_file.h"
#include "abbe/formats/shapes/pcd_file.h"
#include "abbe/formats/shapes/pcd_header.h"
#include "abbe/formats/shapes/ply_file.h"
#include "abbe/formats/shapes/point_normals.h"
#include "abbe/formats/shapes/stl_file.h"
#include "abbe/formats/shapes/xyz_text.h"
#include "abbe/formats/text/appended_number.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"

namespace abbe {
namespace {

PointCloudFile parse_plain_csv_cloud(std::string_view contents, const std::string& file,
                                     const PointCloudOptions& options) {
  CsvTable table = read_csv(contents, file, cloud_columns(options.in_plane), options.mapping, options.threads);
  std::size_t normals = 0;
  for (std::size_t k = 3; k < 6; ++k) normals += table.columns[k].present ? 1U : 0U;
  if (normals != 0 && normals != 3) {
    throw InputError({file, 0, 0, "nx"}, "a normal without all of its components",
                     "columns nx, ny, nz or none of them");
  }
  PointCloudFile result;
  result.format = "CSV";
  // The header has the unit of each column.
  result.unit = {FileLength::millimetre, UnitSource::stated};
  const auto rows = static_cast<Eigen::Index>(table.rows);
  result.cloud.points.resize(3, rows);
  for (std::size_t k = 0; k < 3; ++k) {
    if (!table.columns[k].present) {
      result.cloud.points.row(static_cast<Eigen::Index>(k)).setZero();
      continue;
    }
    result.cloud.points.row(static_cast<Eigen::Index>(k)) =
        Eigen::Map<const Eigen::RowVectorXd>(table.columns[k].numbers.data(), rows);
  }
  if (normals == 3) {
    result.cloud.normals.resize(3, rows);
    for (std::size_t k = 0; k < 3; ++k) {
      result.cloud.normals.row(static_cast<Eigen::Index>(k)) =
          Eigen::Map<const Eigen::RowVectorXd>(table.columns[3 + k].numbers.data(), rows);
    }
    for (Eigen::Index i = 0; i < rows; ++i) {
      if (make_unit(result.cloud.normals.col(i))) continue;
      throw InputError({file, csv_line(contents, static_cast<std::size_t>(i)), 0, "nx, ny, nz"},
                       "the normal has no direction", "a vector with a length");
    }
  }
  if (table.columns[6].present) result.deviation_mm = std::move(table.columns[6].numbers);
  result.names = std::move(table.columns[7].labels);
  return result;
}

PointCloudFile parse_csv_cloud(std::string_view contents, const std::string& file, const PointCloudOptions& options) {
  if (options.unit) {
    throw InputError({file, 0, 0, "unit"}, "a CSV file states the unit of each column in its header", "no unit");
  }
  return parse_readable_table(contents, file, cloud_columns(options.in_plane), options.mapping,
                              [&](std::string_view text) { return parse_plain_csv_cloud(text, file, options); });
}

bool has_names(const ColumnMapping& mapping) { return !mapping.columns.empty() || !mapping.ignore.empty(); }

[[noreturn]] void refuse_mapping(const std::string& file) {
  throw InputError({file, 0, 0, ""}, "its columns cannot be named or left out: this is not a CSV file",
                   "a CSV file, whose first line has the names of its columns");
}

/// Numbers between blanks; or else as other programs separate them, or a table with a header.
PointCloudFile parse_xyz_cloud(std::string_view contents, const std::string& file, const PointCloudOptions& options) {
  PointCloudFile result;
  result.unit = agreed_unit(std::nullopt, options.unit, file);
  result.format = "XYZ";
  const double factor = millimetres(result.unit.length);
  const auto parse = [&](std::string_view text) {
    return parse_xyz(text, file, kLargestInput / factor, options.threads);
  };
  const auto as_table = [&] { return plain_table(contents, file, cloud_columns(options.in_plane), options.mapping); };
  if (has_names(options.mapping)) {
    const std::optional<std::string> table = as_table();
    if (!table) refuse_mapping(file);
    return parse_csv_cloud(*table, file, options);
  }
  std::optional<std::string> plain;
  try {
    result.cloud = parse(contents);
  } catch (const InputError&) {
    const std::optional<std::string> table = as_table();
    if (table) return parse_csv_cloud(*table, file, options);
    plain = plain_points(contents, file);
    if (!plain) throw;
  }
  if (plain) result.cloud = parse(*plain);
  result.cloud.points *= factor;
  return result;
}

}  // namespace

std::vector<CsvColumn> cloud_columns(bool in_plane) {
  std::vector<CsvColumn> wanted;
  for (const char* name : {"x", "y"}) wanted.push_back({name, Quantity::length});
  wanted.push_back({"z", Quantity::length, false, !in_plane});
  for (const char* name : {"nx", "ny", "nz"}) wanted.push_back({name, Quantity::dimensionless, false, false});
  wanted.push_back({"deviation", Quantity::length, false, false});
  CsvColumn name{"point", Quantity::dimensionless, true, false};
  name.is_label = true;
  wanted.push_back(name);
  return wanted;
}

PointCloudFile parse_point_cloud(std::string_view contents, const std::string& file, const PointCloudOptions& options) {
  const std::string extension = file_extension(without_gz(with_ending(file, contents)));
  const bool is_shape = is_e57(contents) || is_pcd(contents) || is_ply(contents) || is_binary_stl(contents) ||
                        extension == ".e57" || extension == ".pcd" || extension == ".ply" || extension == ".obj" ||
                        extension == ".stl";
  if (is_shape && has_names(options.mapping)) refuse_mapping(file);
  if (is_e57(contents) || extension == ".e57") return parse_e57(contents, file, options.unit, options.threads);
  if (is_pcd(contents) || extension == ".pcd") return parse_pcd(contents, file, options.unit);
  PointCloudFile result;
  if (is_ply(contents)) {
    PlyContents ply = parse_ply(contents, file, options.unit);
    result.cloud = {std::move(ply.points), std::move(ply.normals)};
    result.format = ply.format;
    result.unit = ply.unit;
    return result;
  }
  if (extension == ".obj") {
    ObjContents obj = parse_obj(contents, file, options.unit, options.threads);
    result.cloud = {std::move(obj.points), std::move(obj.normals)};
    result.format = "OBJ";
    result.unit = obj.unit;
    return result;
  }
  if (extension == ".csv") return parse_csv_cloud(contents, file, options);
  if (extension == ".stl" || is_binary_stl(contents)) {
    throw InputError({file, 0, 0, ""}, "this is an STL file, a mesh", "a point cloud: XYZ, CSV, PLY, PCD, E57 or OBJ");
  }
  if (file == kStandardInput && extension != ".xyz") {
    refuse_contents(file, contents, "a point cloud", {".xyz", ".csv", ".ply", ".pcd", ".e57", ".obj"});
  }
  if (extension == ".ply") throw InputError({file, 1, 0, ""}, "this is not a PLY file", "a first line 'ply'");
  return parse_xyz_cloud(contents, file, options);
}

PointCloudFile read_point_cloud(const std::filesystem::path& path, const PointCloudOptions& options) {
  const UnpackedFile file(path);
  const std::string name = path.string();
  const bool is_text =
      !is_e57(file.text()) && !is_pcd(file.text()) && !is_ply(file.text()) && !is_binary_stl(file.text());
  const std::optional<std::string> decoded = is_text ? text_in_utf8(file.text(), name) : std::nullopt;
  return parse_point_cloud(decoded ? std::string_view(*decoded) : file.text(), name, options);
}

bool has_point_cloud_extension(const std::filesystem::path& path) {
  const std::string extension = file_extension(path);
  return extension == ".xyz" || extension == ".asc" || extension == ".pts" || extension == ".csv" ||
         extension == ".pcd" || extension == ".e57";
}

std::string cloud_words(const PointCloudFile& file) {
  std::string words = file.format + ", " + unit_words(file.unit);
  for (const std::string& note : file.notes) words += "; " + note;
  return words;
}

std::string point_cloud_csv(const PointCloud& cloud, const std::vector<double>& deviation_mm,
                            const std::vector<std::string>& names) {
  assert(names.empty() || names.size() == static_cast<std::size_t>(cloud.size()));
  assert(deviation_mm.empty() || deviation_mm.size() == static_cast<std::size_t>(cloud.size()));
  if (!cloud.has_normals() && !deviation_mm.empty() && names.empty()) {
    std::string text(kDeviationCsvHeader);
    append_deviation_rows({cloud.points.data(), static_cast<std::size_t>(cloud.points.size())}, deviation_mm, text);
    return text;
  }
  std::string text = "x_mm,y_mm,z_mm";
  if (cloud.has_normals()) text += ",nx,ny,nz";
  if (!deviation_mm.empty()) text += ",deviation_mm";
  if (!names.empty()) text += ",point";
  text += '\n';
  for (Eigen::Index i = 0; i < cloud.size(); ++i) {
    for (Eigen::Index k = 0; k < 3; ++k) {
      if (k > 0) text += ',';
      append_shortest_text(cloud.points(k, i), 0, text);
    }
    for (Eigen::Index k = 0; cloud.has_normals() && k < 3; ++k) {
      append_shortest_text(cloud.normals(k, i), 0, text += ',');
    }
    if (!deviation_mm.empty()) append_shortest_text(deviation_mm[static_cast<std::size_t>(i)], 0, text += ',');
    if (!names.empty()) text += ',' + csv_field(names[static_cast<std::size_t>(i)]);
    text += '\n';
  }
  return text;
}

void append_deviation_rows(std::span<const double> points, std::span<const double> deviation_mm, std::string& text) {
  assert(points.size() == 3 * deviation_mm.size());
  for (std::size_t i = 0; i < deviation_mm.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      append_shortest_text(points[3 * i + k], 0, text);
      text += ',';
    }
    append_shortest_text(deviation_mm[i], 0, text);
    text += '\n';
  }
}

}  // namespace abbe
