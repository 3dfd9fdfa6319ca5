#include "abbe/formats/study/study_direction.h"

namespace abbe {

Eigen::Vector3d read_direction(TomlTable& table, std::string_view key, std::optional<Eigen::Vector3d> otherwise) {
  const std::optional<std::vector<double>> given = table.optional_numbers(key, Quantity::dimensionless, 3);
  if (!given && otherwise) return *otherwise;
  const std::vector<double> values = given ? *given : table.numbers(key, Quantity::dimensionless, 3);
  Eigen::Vector3d direction(values[0], values[1], values[2]);
  if (!(direction.norm() > 1e-6)) table.fail(key, "has no length", "a direction, as [0, 0, 1]");
  return direction;
}

}  // namespace abbe
