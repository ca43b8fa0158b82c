#include <gtest/gtest.h>

#include <future>
#include <stdexcept>

#include "raykiln/shading/made_once.hpp"

namespace raykiln::render {
namespace {

std::stop_token stopped() {
  std::stop_source source;
  source.request_stop();
  return source.get_token();
}

TEST(MadeOnce, IsMadeByTheFirstWhoBringsItToAnEnd) {
  MadeOnce thing;
  int made = 0;
  const auto make = [&](bool whole) { return ++made, whole; };
  EXPECT_FALSE(thing.done());
  EXPECT_FALSE(thing.once({}, [&] { return make(false); })) << "stopped half-way";
  EXPECT_FALSE(thing.done());
  EXPECT_THROW((void)thing.once({}, [&]() -> bool { throw std::runtime_error("no memory"); }), std::runtime_error);
  EXPECT_TRUE(thing.once({}, [&] { return make(true); }));
  EXPECT_TRUE(thing.once(stopped(), [&] { return make(true); })) << "it is there, stop or not";
  EXPECT_TRUE(thing.done());
  EXPECT_EQ(made, 2);
}

/// Whoever waits for another's making is let go when told to stop, and gets it where he waits on.
TEST(MadeOnce, WhoWaitsIsLetGoWhenToldToStop) {
  MadeOnce thing;
  std::promise<void> begun, go_on;
  auto maker = std::async(std::launch::async, [&] {
    return thing.once({}, [&] {
      begun.set_value();
      go_on.get_future().wait();
      return true;
    });
  });
  begun.get_future().wait();
  const auto never = []() -> bool { throw std::logic_error("another is at it"); };
  EXPECT_FALSE(thing.once(stopped(), never));
  std::stop_source leaving;
  auto impatient = std::async(std::launch::async, [&] { return thing.once(leaving.get_token(), never); });
  auto patient = std::async(std::launch::async, [&] { return thing.once({}, never); });
  leaving.request_stop();
  EXPECT_FALSE(impatient.get());
  EXPECT_FALSE(thing.done());
  go_on.set_value();
  EXPECT_TRUE(maker.get());
  EXPECT_TRUE(patient.get());
}

}  // namespace
}  // namespace raykiln::render
