#include "abbe/formats/machine/transform_file.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/number_text.h"

namespace abbe {
namespace {

constexpr std::string_view kStatusComment = "# status: ";

/// The first status among the comments before the header.
std::string status_of_transform(std::string_view contents) {
  while (!contents.empty()) {
    std::string_view line = contents.substr(0, contents.find('\n'));
    contents.remove_prefix(std::min(contents.size(), line.size() + 1));
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
    if (line.starts_with(kStatusComment)) return std::string(line.substr(kStatusComment.size()));
    if (!line.empty() && line.front() != '#') break;
  }
  return {};
}

}  // namespace

RigidTransform parse_transform(std::string_view contents, const std::string& file) {
  const CsvTable table = read_csv(contents, file,
                                  {{"rotation_x", Quantity::dimensionless},
                                   {"rotation_y", Quantity::dimensionless},
                                   {"rotation_z", Quantity::dimensionless},
                                   {"translation", Quantity::length}},
                                  {}, 1);
  if (table.rows != 3) {
    throw InputError({file, 0, 0, ""}, fmt::format("{} rows below the header", table.rows), "three, for x, y and z");
  }
  RigidTransform result;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t k = 0; k < 3; ++k) {
      result.rotation(static_cast<int>(row), static_cast<int>(k)) = table.columns[k].numbers[row];
    }
    result.translation[static_cast<int>(row)] = table.columns[3].numbers[row];
  }
  const double off =
      (result.rotation.transpose() * result.rotation - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(off < 1e-5)) {
    throw InputError(
        {file, 0, 0, "rotation_x, rotation_y, rotation_z"},
        fmt::format("not a rotation matrix: its columns deviate from unit length or right angles by {:.2g}", off),
        "a rotation, off by at most 1e-5");
  }
  if (result.rotation.determinant() < 0) {
    throw InputError({file, 0, 0, "rotation_x, rotation_y, rotation_z"}, "a mirrored matrix", "a rotation");
  }
  // What Abbe wrote itself comes back to the same bits.
  if (off > 1e-14) result.rotation = Eigen::Quaterniond(result.rotation).normalized().toRotationMatrix();
  return result;
}

RigidTransform read_transform(const std::filesystem::path& path) {
  return parse_transform(read_text_file(path), path.string());
}

TransformFile parse_transform_file(std::string_view contents, const std::string& file) {
  return {parse_transform(contents, file), status_of_transform(contents)};
}

TransformFile read_transform_file(const std::filesystem::path& path) {
  return parse_transform_file(read_text_file(path), path.string());
}

std::string transform_csv(const RigidTransform& transform, const std::string& status) {
  std::string text = status.empty() ? "" : std::string(kStatusComment) + status + "\n";
  text += "rotation_x,rotation_y,rotation_z,translation_mm\n";
  for (int row = 0; row < 3; ++row) {
    for (int k = 0; k < 3; ++k) text += shortest_text(transform.rotation(row, k)) + ",";
    text += shortest_text(transform.translation[row]) + "\n";
  }
  return text;
}

}  // namespace abbe
