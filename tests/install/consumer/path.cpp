#include <abbe/formats/files/results_folder.h>
#include <abbe/formats/machine/machine_file.h>
#include <abbe/formats/shapes/curve_file.h>
#include <abbe/study/planned_path.h>

#include <cstdio>

int main(int /*argc*/, char** arguments) {
  abbe::PathRequest request;
  request.machine = abbe::read_machine(arguments[1]);
  request.curve_file = arguments[2];
  request.curve = abbe::read_curve(request.curve_file, request.machine);
  request.placement = abbe::read_placement(arguments[3]);
  const abbe::PlannedPath planned = abbe::plan_path(request);
  if (planned.has_path()) {
    abbe::write_file_atomically("program.ngc", abbe::planned_path_file(planned, "program.ngc"));
    std::fputs(abbe::planned_path_text(planned).c_str(), stdout);
  }
  std::fputs(planned.refused.c_str(), stderr);
  return planned.refused.empty() ? 0 : 1;
}
