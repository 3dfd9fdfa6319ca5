#include "abbe/formats/nc/nc_program.h"

#include "abbe/formats/nc/nc_interpreter.h"
#include "abbe/formats/nc/nc_writer.h"

namespace abbe {

NcProgramResult correct_nc_program(std::string_view text, const std::string& file, const NcProgramOptions& options,
                                   MoveCorrector& corrector, const std::function<void(std::string_view)>& write,
                                   const std::function<void(std::size_t)>& read_to) {
  const std::function<void(std::string_view)> write_within_budget = [&](std::string_view part) {
    if (options.budget != nullptr) options.budget->wrote(part.size());
    refuse_spent_budget(options);
    write(part);
  };
  NcWriter writer(file, options, corrector, write_within_budget);
  NcInterpreter interpreter(text, file, options, writer);
  NcProgramResult result;
  try {
    result.lines = interpreter.run(read_to);
    writer.finish();
  } catch (const NcGivenUp& given_up) {
    result.spent = given_up.spent;
    result.given_up_line = interpreter.line();
  }
  result.moves = writer.moves();
  result.pieces = writer.pieces();
  result.uncorrected_moves = writer.uncorrected();
  result.first_uncorrected_line = writer.first_uncorrected_line();
  result.first_assumed_offset_line = interpreter.first_assumed_offset_line();
  return result;
}

}  // namespace abbe
