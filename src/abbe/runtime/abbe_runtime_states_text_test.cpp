#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "abbe/runtime/frozen_states_for_test.h"

namespace abbe {
namespace {

constexpr double kNow = 1764364800.25;  // s since 1970

/// A compensation of its own for every test, and its states.
struct Kept {
  test::RuntimePointer runtime = test::loaded(test::frozen_warm_mill().bytes);
  test::StatesPointer states = test::states_of(runtime.get());

  void advance(double ambient, double seconds) { abbe_runtime_states_advance(states.get(), &ambient, seconds); }
  double lag() const {
    double value = 0;
    abbe_runtime_states_get(states.get(), nullptr, &value, nullptr, nullptr);
    return value;
  }
  std::string text(double now = kNow) const {
    char room[500];
    return {room, abbe_runtime_states_text(states.get(), now, room, sizeof room)};
  }
  int restore(const std::string& text, double now = kNow, double largest_age_s = 86400) const {
    return abbe_runtime_states_restore_text(states.get(), text.data(), text.size(), now, largest_age_s);
  }
};

/// A machine that was warmed up.
Kept warmed() {
  Kept kept;
  kept.advance(20, 0);
  for (int k = 1; k <= 600; ++k) kept.advance(20 + 0.01 * k, 1);
  return kept;
}

TEST(RuntimeStatesText, LagsGoOnAsIfTheyHadNotBeenInterrupted) {
  Kept through = warmed();
  const std::string text = through.text();
  EXPECT_NE(text.find("channel ambient 26\n"), std::string::npos) << text;
  const Kept restarted;
  ASSERT_EQ(restarted.restore(text, kNow + 300), ABBE_OK);
  EXPECT_TRUE(std::isnan(restarted.lag())) << "before a value of its channel has come";
  // Off for 300 s, then 20 s until the sensor answers; the channel went from 26 to 24 meanwhile.
  const double dead = std::numeric_limits<double>::quiet_NaN(), ambient = 24;
  abbe_runtime_states_advance(restarted.states.get(), &dead, 15);
  abbe_runtime_states_advance(restarted.states.get(), &ambient, 5);
  through.advance(24, 320);
  EXPECT_NEAR(restarted.lag(), through.lag(), 1e-12);
  EXPECT_GT(std::abs(through.lag() - 24), 0.1) << "equilibrium would be something else";
  const Kept cold;
  abbe_runtime_states_advance(cold.states.get(), &ambient, 0);
  EXPECT_EQ(cold.lag(), 24);
}

TEST(RuntimeStatesText, AnyOrderIsRead) {
  const std::string text = warmed().text();
  const std::size_t channel = text.find("channel "), lag = text.find("lag "), end = text.find("end\n");
  const std::string turned =
      text.substr(0, channel) + text.substr(lag, end - lag) + text.substr(channel, lag - channel) + "end\n";
  EXPECT_EQ(Kept().restore(turned), ABBE_OK);
}

TEST(RuntimeStatesText, StaleAndForeignOnesAreRefused) {
  const std::string text = warmed().text();
  const Kept kept;
  EXPECT_EQ(kept.restore(text, kNow - 0.01), ABBE_STALE) << "from the future";
  EXPECT_EQ(kept.restore(text, kNow + 86400.1), ABBE_STALE);
  EXPECT_EQ(kept.restore(text, kNow + 86399.9), ABBE_OK);
  EXPECT_EQ(kept.restore(text, std::numeric_limits<double>::quiet_NaN()), ABBE_STALE);
  EXPECT_EQ(kept.restore(""), ABBE_FILE_FOREIGN);
  EXPECT_EQ(kept.restore("something else\n"), ABBE_FILE_FOREIGN);
  std::string other = text;
  const std::size_t sum = text.find("compensation ") + 13;
  other[sum] = other[sum] == '0' ? '1' : '0';
  EXPECT_EQ(kept.restore(other), ABBE_FILE_FOREIGN) << "of another compensation";
  const test::RuntimePointer plain = test::runtime_of(test::three_axis_mill(), {});
  const test::StatesPointer none = test::states_of(plain.get());
  EXPECT_EQ(abbe_runtime_states_restore_text(none.get(), text.data(), text.size(), kNow, 1e9), ABBE_FILE_FOREIGN);
}

TEST(RuntimeStatesText, DamagedOnesAreRefusedAndChangeNothing) {
  const std::string text = warmed().text();
  const Kept kept;
  for (std::size_t size = 14; size < text.size(); ++size)
    EXPECT_LT(kept.restore(text.substr(0, size)), 0) << "cut at " << size;
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string other = text;
    other.replace(other.find(from), from.size(), to);
    return kept.restore(other);
  };
  EXPECT_EQ(changed("channel ambient 26", "channel ambient nan"), ABBE_FILE_CONTENT);
  EXPECT_EQ(changed("channel ambient 26", "channel ambient 26 C"), ABBE_FILE_CONTENT);
  EXPECT_EQ(changed("channel ambient 26", "channel ambient 1e300"), ABBE_FILE_CONTENT);
  EXPECT_EQ(changed("channel ambient 26\n", ""), ABBE_FILE_CONTENT);
  EXPECT_EQ(changed("channel ambient 26\n", "channel ambient 26\nchannel ambient 26\n"), ABBE_FILE_CONTENT);
  EXPECT_EQ(changed("lag column", "lag columns"), ABBE_FILE_CONTENT);
  EXPECT_EQ(changed("time ", "time x"), ABBE_FILE_CONTENT);
  EXPECT_EQ(changed("end\n", "ende\n"), ABBE_FILE_CONTENT);
  const double ambient = 24;
  abbe_runtime_states_advance(kept.states.get(), &ambient, 0);
  EXPECT_EQ(kept.lag(), 24) << "in equilibrium: nothing was taken up";
}

TEST(RuntimeStatesText, NothingIsStoredWhileAChannelIsNotAsItShouldBe) {
  Kept kept;
  EXPECT_EQ(kept.text(), "") << "no value has come";
  kept.advance(25, 1);
  EXPECT_NE(kept.text(), "");
  kept.advance(std::numeric_limits<double>::quiet_NaN(), 1);
  EXPECT_EQ(kept.text(), "");
  char small[20];
  kept.advance(25, 1);
  EXPECT_EQ(abbe_runtime_states_text(kept.states.get(), kNow, small, sizeof small), 0U);
  EXPECT_EQ(small[0], 0);
}

}  // namespace
}  // namespace abbe
