#include <abbe/formats/files/results_folder.h>
#include <abbe/formats/machine/machine_file.h>
#include <abbe/formats/readings/measurement_file.h>
#include <abbe/study/corrected_commands.h>

#include <cstdio>

int main(int /*argc*/, char** arguments) {
  abbe::CommandsRequest request;
  request.machine = abbe::read_machine(arguments[1]);
  request.errors = abbe::read_errors(arguments[2], request.machine);
  request.poses = abbe::read_poses(arguments[3], request.machine);
  request.limit_um = 500;
  const abbe::CorrectedCommands result = abbe::correct_commands(request);
  if (result.refused.empty()) abbe::write_file_atomically(arguments[4], abbe::corrected_commands_csv(result));
  std::fputs(abbe::corrected_commands_text(result).c_str(), stdout);
  return result.refused.empty() && result.not_reached == 0 ? 0 : 1;
}
