#include "scan/scan_files.h"

#include "abbe/formats/text/file_unit.h"
#include "options.h"

namespace abbe {

PointCloudOptions ScanFiles::scan_options() const {
  return {.unit = file_length_named(scan_unit), .mapping = columns.mapping(), .threads = threads};
}

PointCloudFile ScanFiles::read_scan() const { return read_point_cloud(scan, scan_options()); }

MeshFile ScanFiles::read_part() const {
  step.require_step_among({part});
  return step.read(part, file_length_named(part_unit), threads);
}

void add_scan_files(Subcommand* command, ScanFiles& files) {
  command
      ->add_input_file("scan", files.scan, "Points of the scan (.csv .xyz .ply .pcd .e57 .obj; docs/geometry-files.md)")
      ->required();
  command->add_input_file("part", files.part, "Surface of the part (.stl .ply .obj .step)")->required();
  const Check units = one_of(file_length_names());
  command->add_option("--scan-unit", files.scan_unit, "Unit of a scan file that states none (mm)")->check(units);
  add_columns(command, files.columns, "x_mm=East");
  command->add_option("--part-unit", files.part_unit, "Unit of a part file that states none (mm)")->check(units);
  files.step.add_to(command);
  command->add_option("--threads", files.threads, "Threads; the result does not depend on them (default: all)")
      ->check(in_range(0, 1024));
}

}  // namespace abbe
