#include <abbe/formats/files/results_folder.h>
#include <abbe/study/found_positions.h>

#include <cstdio>

int main(int /*argc*/, char** arguments) {
  const abbe::PositionsRequest request = abbe::read_positions_request(arguments[1]);
  const abbe::FoundPositions found = abbe::find_positions(request);
  if (!found.is_ok()) {
    std::fputs(found.problem.c_str(), stderr);
    return 1;
  }
  std::fputs(abbe::found_positions_text(found).c_str(), stdout);
  if (found.workpiece) abbe::write_file_atomically(arguments[2], abbe::found_placement_file(found));
  return 0;
}
