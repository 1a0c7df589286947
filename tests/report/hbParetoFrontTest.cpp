#include "report/hbParetoFront.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

using hb::CostAndError;

TEST(hbParetoFront, LeavesOutWhatAnotherChoiceBeats) {
  const std::vector<CostAndError> choices{{1.0, 5.0}, {2.0, 3.0}, {2.0, 4.0}, {3.0, 3.0}, {4.0, 1.0}, {2.0, 3.0}};
  EXPECT_EQ(hb::paretoFront(choices), (std::vector<bool>{true, true, false, false, true, true}));
  EXPECT_TRUE(hb::paretoFront({}).empty());
}

RC_GTEST_PROP(hbParetoFront, IsItsDefinition, ()) {
  // Few different numbers, so that many are equal.
  std::vector<CostAndError> choices;
  for (int i = *rc::gen::inRange(0, 20); i > 0; --i)
    choices.push_back({double(*rc::gen::inRange(0, 5)), double(*rc::gen::inRange(0, 5))});
  const std::vector<bool> front = hb::paretoFront(choices);
  for (std::size_t i = 0; i < choices.size(); ++i) {
    bool isBeaten = false;
    for (const CostAndError& other : choices)
      isBeaten = isBeaten || (other.cost <= choices[i].cost && other.error <= choices[i].error &&
                              (other.cost < choices[i].cost || other.error < choices[i].error));
    RC_ASSERT(front[i] == !isBeaten);
  }
}
