// SPDX-License-Identifier: Apache-2.0
// JSON and page from one list of values.
#include "report/values.h"

#include <gtest/gtest.h>

namespace fourdvt::report {
namespace {

Values frameValues(int frame) {
  return {{"frame", "frame", Json(frame)},
          {"error/mean_mm", "error, mm", 1.25, 1},
          {"seed", Json(7)},  // in JSON only
          {"", "note", Json("on the page only")}};
}

TEST(Values, JsonHasEveryKeyAndNoTitle) {
  EXPECT_EQ(jsonOf(frameValues(3)).dump(), R"({"frame":3,"error":{"mean_mm":1.25},"seed":7})");
  EXPECT_EQ(jsonOf(std::vector<Values>{frameValues(0), frameValues(1)}).size(), 2u);
}

TEST(Values, TableHasTitledValuesOnly) {
  const Table table = tableOf("frames", "", {frameValues(0), frameValues(1)});
  EXPECT_EQ(table.columns, (std::vector<std::string>{"frame", "error, mm", "note"}));
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[1], (std::vector<std::string>{"1", "1.2", "on the page only"}));
}

TEST(Values, TilesAndFactsHaveTitledValuesOnly) {
  EXPECT_EQ(tilesOf(frameValues(0)).size(), 3u);
  const Table facts = factsOf(frameValues(0));
  ASSERT_EQ(facts.rows.size(), 3u);
  EXPECT_EQ(facts.rows[1], (std::vector<std::string>{"error, mm", "1.2"}));
}

}  // namespace
}  // namespace fourdvt::report
