#include "abbe/formats/machine/placement_file.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/text/number_text.h"
#include "abbe/formats/text/toml_table.h"

namespace abbe {

PlacementFile parse_placement(const std::string& text, const std::string& file) {
  TomlTable root = TomlTable::parse(text, file);
  const std::size_t maps = root.word("maps", {"table-to-workpiece", "workpiece-to-table"});
  const std::vector<double> t = root.numbers("translation", Quantity::length, 3);
  const std::vector<double> a = root.numbers("angles", Quantity::angle, 3);
  std::vector<std::string> warnings = root.texts_or_none("warnings");
  root.finish();
  const RigidTransform given = {rotation_xyz({a[0], a[1], a[2]}), {t[0], t[1], t[2]}};
  return {{maps == 0 ? given.inverse() : given}, std::move(warnings)};
}

PlacementFile read_placement(const std::filesystem::path& path) {
  return parse_placement(read_file_of_kind(path, ".placement.toml"), path.string());
}

std::string placement_text(const PlacementFile& file, bool table_to_workpiece) {
  const Placement& placement = file.placement;
  const RigidTransform given =
      table_to_workpiece ? placement.table_from_workpiece.inverse() : placement.table_from_workpiece;
  const Eigen::Vector3d angles = angles_xyz(given.rotation);
  std::string text = fmt::format("# Where the workpiece is clamped: {}.\n",
                                 table_to_workpiece ? "p_workpiece = D p_table" : "p_table = D p_workpiece");
  text += fmt::format("maps = \"{}\"\n", table_to_workpiece ? "table-to-workpiece" : "workpiece-to-table");
  text += fmt::format("translation_mm = [{}, {}, {}]\n", shortest_text(given.translation.x()),
                      shortest_text(given.translation.y()), shortest_text(given.translation.z()));
  text += toml_angles("angles", {angles.x(), angles.y(), angles.z()});  // Rx Ry Rz
  if (placement.covariance) {
    const auto& c = *placement.covariance;
    const auto u = [&](int i) { return std::sqrt(std::max(0.0, c(i, i))); };
    text += fmt::format(
        "# standard uncertainties in the table's frame: workpiece origin {:.2f}, {:.2f}, {:.2f} um, turned by "
        "{:.1f}, {:.1f}, {:.1f} urad\n",
        1e3 * u(0), 1e3 * u(1), 1e3 * u(2), 1e6 * u(3), 1e6 * u(4), 1e6 * u(5));
  }
  return text + toml_texts("warnings", file.warnings);
}

}  // namespace abbe
