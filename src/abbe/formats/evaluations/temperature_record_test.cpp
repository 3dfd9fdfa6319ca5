#include "abbe/formats/evaluations/temperature_record.h"

#include <gtest/gtest.h>

#include "abbe/formats/files/text_file.h"
#include "abbe/formats/text/message_of.h"

namespace abbe {
namespace {

TEST(TemperatureRecord, HoldsOneOrBothBodiesOverTime) {
  const TemperatureRecord record =
      parse_temperature_record("time_min,machine_degC,instrument_degC\n0,22,21\n1,,22\n2,24,\n", "t.csv");
  ASSERT_TRUE(record.machine && record.instrument);
  EXPECT_EQ(record.machine->time, (std::vector<double>{0, 120}));
  EXPECT_EQ(value_at(*record.machine, 60), 23);
  EXPECT_EQ(record.instrument->values, (std::vector<double>{21, 22}));
  EXPECT_FALSE(parse_temperature_record("time_s,machine_degC\n0,22\n1,23\n", "t.csv").instrument);
}

TEST(TemperatureRecord, SaysWhatIsWrongAndWhere) {
  const auto refused = [](const char* text) { return message_of([&] { parse_temperature_record(text, "t.csv"); }); };
  EXPECT_EQ(refused("time_s\n0\n"),
            "t.csv: machine_degC: missing column; expected machine_degC, instrument_degC or both");
  EXPECT_EQ(refused("time_s,machine_degC\n0,22\n"), "t.csv: machine_degC: 1 readings; expected two at least");
  EXPECT_EQ(refused("time_s,machine_degC\n5,22\n4,23\n").substr(0, 33), "t.csv:3: time_s: 4 s follows 5 s;");
}

}  // namespace
}  // namespace abbe
