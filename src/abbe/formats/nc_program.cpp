#include "abbe/formats/nc_program.h"

#include "abbe/formats/nc_interpreter.h"
#include "abbe/formats/nc_writer.h"

namespace abbe {

NcProgramResult correct_nc_program(std::string_view text, const std::string& file, const NcProgramOptions& options,
                                   MoveCorrector& corrector, const std::function<void(std::string_view)>& write,
                                   const std::function<void(std::size_t)>& read_to) {
  NcWriter writer(file, options, corrector, write);
  NcInterpreter interpreter(text, file, options, writer);
  NcProgramResult result;
  result.lines = interpreter.run(read_to);
  writer.finish();
  result.moves = writer.moves();
  result.pieces = writer.pieces();
  result.uncorrected_moves = writer.uncorrected();
  result.first_uncorrected_line = writer.first_uncorrected_line();
  result.first_assumed_offset_line = interpreter.first_assumed_offset_line();
  return result;
}

}  // namespace abbe
