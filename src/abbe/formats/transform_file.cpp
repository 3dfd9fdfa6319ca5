#include "abbe/formats/transform_file.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include "abbe/formats/csv_reader.h"
#include "abbe/formats/input_error.h"
#include "abbe/formats/number_text.h"
#include "abbe/formats/text_file.h"

namespace abbe {

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
    throw InputError({file, 0, 0, "rotation_x, rotation_y, rotation_z"},
                     fmt::format("no rotation matrix: its columns are off unit length or right angles by {:.2g}", off),
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

std::string transform_csv(const RigidTransform& transform) {
  std::string text = "rotation_x,rotation_y,rotation_z,translation_mm\n";
  for (int row = 0; row < 3; ++row) {
    for (int k = 0; k < 3; ++k) text += shortest_text(transform.rotation(row, k)) + ",";
    text += shortest_text(transform.translation[row]) + "\n";
  }
  return text;
}

}  // namespace abbe
